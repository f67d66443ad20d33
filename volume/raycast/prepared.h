// SPDX-License-Identifier: Apache-2.0
// What a ray caster prepares from a classification before it casts rays, and keeps from image to image: tables,
// which blocks show something (empty-space skipping), bounds of blocks, and the division of adaptive steps. A
// part of ray_caster.cc.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/raycast/block_bounds.h"
#include "volume/raycast/kernel.h"
#include "volume/raycast/map_visibility.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/pre_integration.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume {

/// The most blocks between the front and the back of a slice segment, per axis.
inline std::array<int, 3> blocks_in_reach(const VolumeDescription& volume,
                                          const std::optional<SliceSegment>& slice_segment) {
  std::array<int, 3> blocks{};
  for (std::size_t axis = 0; slice_segment && axis < 3; ++axis) {
    constexpr double rounding = 1e-2;  // of positions, in cells
    blocks[axis] =
        int(std::ceil((slice_segment->reach[axis] * volume.size[axis] + rounding) / BrickStore::block_cells));
  }
  return blocks;
}

/// What the preparation of a request depends on, apart from its classification.
struct PreparedKey {
  bool keeps_clear_samples = false;  ///< under `min`
  std::array<int, 3> reach{};        ///< of slice segments, in blocks
  bool pre_integrated = false;
  float tolerance = 0;        ///< of adaptive steps, otherwise 0
  double step_cells = 0;      ///< length of adaptive steps
  bool skips = true;          ///< Optimizations::empty_bricks
  std::vector<float> levels;  ///< of surfaces, in units of the texel type

  bool operator==(const PreparedKey&) const = default;
};

inline PreparedKey prepared_key_of(const VolumeDescription& volume, const RenderRequest& request) {
  PreparedKey c;
  c.keeps_clear_samples = request.op == Operator::min;
  c.reach = blocks_in_reach(volume, request.slice_segment);
  c.skips = request.optimizations.empty_bricks;
  c.pre_integrated = request.method == Method::pre_integrated;
  if (request.method == Method::adaptive) {
    c.tolerance = request.tolerance;
    const std::array<double, 3> reach = step_reach(volume, request);
    c.step_cells = *std::max_element(reach.begin(), reach.end());
  }
  for (const Level& level : SegmentScene(volume, request).levels) c.levels.push_back(level.value);
  return c;
}

/// Reused from image to image as long as classification and prepared key stay the same.
struct RayCaster::Prepared {
  Classification classification;
  PreparedKey prepared_key;
  std::optional<TransferTable> table;
  std::optional<PreIntegrationLookup> pairs;
  OccupancyMap skip;
  std::optional<std::vector<float>> bounds;  ///< computed for the first maximum
  bool values_beyond = false;                ///< Scene::values_beyond
  std::optional<PartTable> parts;            ///< this and `division`: for adaptive steps
  std::optional<StepDivision> division;

  bool visible(const BrickStore& store, std::size_t block) const {
    if (!prepared_key.skips) return true;
    const auto ranges = store.ranges(block);
    if (prepared_key.keeps_clear_samples) return ranges[0].low <= ranges[0].high;
    if (std::any_of(prepared_key.levels.begin(), prepared_key.levels.end(),
                    [&](float level) { return ranges[0].low <= level && level <= ranges[0].high; }))
      return true;
    if (table) return table->shows(ranges[0]);
    return shows(std::get<LinearMap>(classification), ranges);
  }

  OccupancyMap occupancy_map(const BrickStore& store) const {
    if (!prepared_key.skips) return OccupancyMap(store.block_counts(), std::vector<bool>(store.blocks(), true));
    if (has_slice_segments())
      return OccupancyMap(store.block_counts(), blocks_with_slice_segments(store, *pairs, prepared_key.reach,
                                                                           prepared_key.keeps_clear_samples));
    std::vector<bool> all(store.blocks());
    for (std::size_t b = 0; b < all.size(); ++b) all[b] = visible(store, b);
    return OccupancyMap(store.block_counts(), std::move(all));
  }

  bool has_slice_segments() const { return pairs && !prepared_key.pre_integrated; }

  /// Adds the prepared data to the scene of `request`.
  void complete(Scene& scene, const RenderRequest& request, const BrickStore& store) {
    scene.skip = &skip;
    scene.table = table ? &*table : nullptr;
    scene.map = std::get_if<LinearMap>(&classification);
    scene.pairs = pairs ? &*pairs : nullptr;
    scene.values_beyond = values_beyond;
    scene.parts = parts ? &*parts : nullptr;
    scene.division = division ? &*division : nullptr;
    if (request.op != Operator::max || !table || request.fog || !request.optimizations.dominated_samples)
      return;
    if (!bounds) bounds = block_bounds(store, *table);
    if (!bounds->empty()) scene.bounds = bounds->data();
  }

  bool lies_beyond(const BrickStore& store, std::size_t block) const {
    const BrickStore::Range& range = store.ranges(block).front();
    const auto place = [&](float value) { return (value - pairs->low()) * pairs->scale(); };
    return range.low <= range.high &&
           (place(range.low) < -table_end_slack || place(range.high) > pairs->last() + table_end_slack);
  }

  void divide_steps(const BrickStore& store) {
    if (!parts) return;
    division.emplace(store, std::get<TransferFunction>(classification), double(prepared_key.tolerance),
                     prepared_key.step_cells);
  }

  void blocks_changed(const BrickStore& store, std::span<const std::size_t> blocks) {
    divide_steps(store);
    if (has_slice_segments()) {
      // The back of a segment may lie in another block.
      skip = occupancy_map(store);
      return;
    }
    if (bounds && !bounds->empty())
      for (const std::size_t b : blocks) (*bounds)[b] = block_bound(store, *table, b);
    if (prepared_key.pre_integrated)
      values_beyond = values_beyond || std::any_of(blocks.begin(), blocks.end(),
                                                   [&](std::size_t b) { return lies_beyond(store, b); });
    // Distances depend only on which blocks show something.
    if (std::all_of(blocks.begin(), blocks.end(),
                    [&](std::size_t b) { return visible(store, b) == skip.shows(b); }))
      return;
    std::vector<bool> all(store.blocks());
    for (std::size_t b = 0; b < all.size(); ++b) all[b] = skip.shows(b);
    for (const std::size_t b : blocks) all[b] = visible(store, b);
    skip = OccupancyMap(store.block_counts(), std::move(all));
  }

  static std::optional<TransferTable> make_table(const BrickStore& store, const Classification& classification,
                                                 bool keeps_clear_samples) {
    const auto* function = std::get_if<TransferFunction>(&classification);
    if (!function) return std::nullopt;
    return TransferTable(*function, store.description().type,
                         neutral_value(keeps_clear_samples ? Operator::min : Operator::over));
  }

  static std::optional<PreIntegrationLookup> make_pairs(const BrickStore& store,
                                                        const Classification& classification,
                                                        const PreparedKey& prepared_key) {
    const float neutral = neutral_value(prepared_key.keeps_clear_samples ? Operator::min : Operator::over);
    if (prepared_key.pre_integrated)
      return PreIntegrationLookup(pre_integrated(std::get<TransferFunction>(classification)),
                                  store.description().type, neutral);
    const auto* pairs = std::get_if<PreIntegrationTable>(&classification);
    if (!pairs) return std::nullopt;
    return PreIntegrationLookup(*pairs, store.description().type, neutral);
  }

  Prepared(const BrickStore& store, const Classification& from, PreparedKey under)
      : classification(from),
        prepared_key(std::move(under)),
        table(make_table(store, classification, prepared_key.keeps_clear_samples)),
        pairs(make_pairs(store, classification, prepared_key)),
        skip(occupancy_map(store)) {
    if (prepared_key.tolerance > 0)
      parts.emplace(std::get<TransferFunction>(classification), store.description().type);
    divide_steps(store);
    for (std::size_t b = 0; prepared_key.pre_integrated && !values_beyond && b < store.blocks(); ++b)
      values_beyond = lies_beyond(store, b);
  }
};

}  // namespace understudy::volume
