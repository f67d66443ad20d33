// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/expected_samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "volume/matrix.h"
#include "volume/raycast/map_visibility.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

/// Cost of passing an empty block, as a fraction of the cost of its samples.
constexpr double passing = 1.0 / 256;

/// Which blocks show something, by the criteria of the ray caster.
class Visibility {
 public:
  Visibility(const BrickStore& store, const RenderRequest& request)
      : store_(store),
        map_(std::get_if<LinearMap>(&request.classification)),
        keeps_all_(request.op == Operator::min || !request.optimizations.empty_bricks) {
    if (const auto* function = std::get_if<TransferFunction>(&request.classification))
      table_.emplace(*function, store.description().type, neutral_value(request.op));
    for (const Level& level : SegmentScene(store.description(), request).levels) levels_.push_back(level.value);
  }

  bool operator()(std::size_t block) const {
    const auto ranges = store_.ranges(block);
    const BrickStore::Range& first = ranges[0];
    if (keeps_all_) return first.low <= first.high;
    if (std::ranges::any_of(levels_, [&](float level) { return first.low <= level && level <= first.high; }))
      return true;
    if (table_) return table_->shows(first);
    return map_ == nullptr || shows(*map_, ranges);
  }

 private:
  const BrickStore& store_;
  std::optional<TransferTable> table_;
  const LinearMap* map_;
  std::vector<float> levels_;
  bool keeps_all_;
};

}  // namespace

double sample_density(const RenderRequest& request, const Vec3& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (t[k] < request.region.low[k] || t[k] > request.region.high[k]) return 0;
  for (const HalfSpace& plane : request.clip_planes)
    if (dot(plane.normal, t) + plane.offset < 0) return 0;
  const Matrix4& m = request.texture_to_clip;
  const Vec4 clip = transform_point(m, t);
  // There are no samples in front of the near plane or behind the far plane.
  if (!(clip[3] > 0) || std::abs(clip[2]) > clip[3]) return 0;
  const double x = clip[0] / clip[3], y = clip[1] / clip[3];
  const double column = request.viewport.x + request.viewport.width * (x + 1) / 2;
  const double row = request.viewport.y + request.viewport.height * (y + 1) / 2;
  const Rect& window = request.window;
  if (column < window.x || column > window.x + window.width || row < window.y || row > window.y + window.height)
    return 0;
  const auto gradient = [&](int of, double at) {
    Vec3 g{};
    for (std::size_t k = 0; k < 3; ++k) g[k] = (m[std::size_t(4 * of) + k] - at * m[12 + k]) / clip[3];
    return g;
  };
  // Both pixel coordinates are constant along the ray.
  const Vec3 along =
      scale(cross(gradient(0, x), gradient(1, y)), 0.25 * request.viewport.width * request.viewport.height);
  if (!request.steps) {
    const SlicePlanes& planes = request.planes;
    const double first = planes.first, last = planes.first + planes.spacing * planes.count;
    const double place = dot(planes.normal, t);
    if (place < std::min(first, last) || place > std::max(first, last)) return 0;
    return std::abs(dot(planes.normal, along) / planes.spacing);
  }
  const std::array<double, 9>& metric = request.steps->metric;
  Vec3 steps{};
  for (std::size_t r = 0; r < 3; ++r)
    steps[r] = metric[3 * r] * along[0] + metric[3 * r + 1] * along[1] + metric[3 * r + 2] * along[2];
  return std::sqrt(dot(steps, steps));
}

void add_expected_samples(const BrickStore& store, const RenderRequest& request, BlockCosts& costs) {
  constexpr int block = BrickStore::block_cells;
  const VolumeDescription& volume = store.description();
  const TexelBox& lattice = costs.lattice();
  const Visibility shows(store, request);
  const auto& first = store.first_block();
  const auto& counts = store.block_counts();
  // One task per layer of cubes: no two tasks add to the same cube.
  const int blocks_per_cube = costs.edge() / block;
  const int last_layer = counts[2] > 0 ? (first[2] + counts[2] - 1) / blocks_per_cube : -1;
  tbb::parallel_for(first[2] / blocks_per_cube, last_layer + 1, [&](int layer) {
    const int from = std::max(0, layer * blocks_per_cube - first[2]);
    const int to = std::min(counts[2], (layer + 1) * blocks_per_cube - first[2]);
    std::size_t index = std::size_t(from) * std::size_t(counts[1]) * std::size_t(counts[0]);
    for (int z = from; z < to; ++z)
      for (int y = 0; y < counts[1]; ++y)
        for (int x = 0; x < counts[0]; ++x, ++index) {
          const std::array<int, 3> place{first[0] + x, first[1] + y, first[2] + z};
          bool own = true;
          double size = 1;  // in units of texture space
          Vec3 middle{};
          std::array<int, 3> cube{};
          for (std::size_t k = 0; k < 3; ++k) {
            const int low = lattice.low[k] + place[k] * block, high = std::min(low + block, lattice.high[k]);
            own = own && low >= store.owned_cells().low[k] && low < store.owned_cells().high[k];
            size *= double(high - low) / volume.size[k];
            middle[k] = (0.5 * (low + high) + 0.5) / volume.size[k];
            cube[k] = place[k] * block / costs.edge();
          }
          if (!own) continue;
          const double samples = size * sample_density(request, middle);
          costs.values()[costs.index(cube)] += shows(index) ? samples : passing * samples;
        }
  });
}

}  // namespace understudy::volume
