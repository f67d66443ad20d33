#include "volume/raycast/ray_caster.h"

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>

#include "volume/brick_grid.h"
#include "volume/footprint.h"
#include "volume/matrix.h"
#include "volume/occlusion.h"
#include "volume/raycast/block_bounds.h"
#include "volume/raycast/kernel.h"
#include "volume/raycast/map_visibility.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/pre_integration.h"
#include "volume/raycast/ray_setup.h"
#include "volume/raycast/segment_scene.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

constexpr std::size_t max_clip_planes = 64;
constexpr int max_window = 65536;

template <typename... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw std::invalid_argument(fmt::format(format, std::forward<Args>(args)...));
}

template <typename Range>
bool all_finite(const Range& values) {
  return std::all_of(values.begin(), values.end(), [](auto v) { return std::isfinite(v); });
}

bool believable(const Rect& rect) {
  const auto in = [](int v) { return v >= -max_window && v <= max_window; };
  return in(rect.x) && in(rect.y) && in(rect.width) && in(rect.height);
}

void validate_classification(const VolumeDescription& volume, const Classification& classification) {
  if (const auto* function = std::get_if<TransferFunction>(&classification)) {
    if (volume.type == TexelType::rgba8)
      refuse("a volume of colours needs a linear map, not a transfer function");
    if (function->entries.size() < 2 || function->entries.size() > max_table_entries)
      refuse("the transfer function has {} entries (2 to {} are possible)", function->entries.size(),
             max_table_entries);
    if (!std::isfinite(function->low) || !std::isfinite(function->high) || !(function->low < function->high))
      refuse("the transfer function spans values {} to {}", function->low, function->high);
    for (const Rgba& entry : function->entries)
      if (!all_finite(entry)) refuse("the transfer function holds a value that is not finite");
  } else if (const auto* pairs = std::get_if<PreIntegrationTable>(&classification)) {
    if (volume.type == TexelType::rgba8)
      refuse("a volume of colours needs a linear map, not a pre-integration table");
    if (pairs->edge < 2 || pairs->edge > max_pre_integration_edge ||
        pairs->entries.size() != std::size_t(pairs->edge) * std::size_t(pairs->edge))
      refuse("the pre-integration table has {} entries and an edge of {} (2 to {} are possible)",
             pairs->entries.size(), pairs->edge, max_pre_integration_edge);
    if (!std::isfinite(pairs->low) || !std::isfinite(pairs->high) || !(pairs->low < pairs->high))
      refuse("the pre-integration table spans values {} to {}", pairs->low, pairs->high);
    for (const Rgba& entry : pairs->entries)
      if (!all_finite(entry)) refuse("the pre-integration table holds a value that is not finite");
  } else {
    const LinearMap& map = std::get<LinearMap>(classification);
    if (volume.type != TexelType::rgba8)
      refuse("a scalar field needs a transfer function, not a linear map of colours");
    if (!all_finite(map.matrix) || std::isnan(map.alpha_above))
      refuse("the map of colours holds a value that is not finite");
  }
}

void validate_steps(const RaySteps& steps, const Box& region) {
  if (!all_finite(steps.metric) || !std::isfinite(steps.first) || !std::isfinite(steps.rounding) ||
      !std::isfinite(steps.past_depth))
    refuse("the steps along rays hold a value that is not finite");
  const auto row = [&](std::size_t r) {
    return Vec3{steps.metric[3 * r], steps.metric[3 * r + 1], steps.metric[3 * r + 2]};
  };
  const double volume = std::abs(dot(row(0), cross(row(1), row(2))));
  const bool regular = steps.between_planes()
                           ? length(row(0)) > 0
                           : volume > 1e-9 * length(row(0)) * length(row(1)) * length(row(2));
  if (!regular) refuse("the metric of the steps along rays is singular");
  if (!(steps.first >= 0 && steps.rounding >= 0 && steps.rounding <= 1 && steps.past_depth >= 0 &&
        steps.first <= max_planes && steps.past_depth <= max_planes))
    refuse("rays begin {} steps from their entry, end {} behind opaque geometry, and are rounded by {}",
           steps.first, steps.past_depth, steps.rounding);
  if (const auto& offsets = steps.offsets) {
    const bool rectangle =
        offsets->width > 0 && offsets->height > 0 &&
        offsets->steps.size() / std::size_t(offsets->width) == std::size_t(offsets->height) &&
        offsets->steps.size() % std::size_t(offsets->width) == 0;
    if (!rectangle) refuse("the offsets of the rays' first samples are no rectangle");
    for (const float offset : offsets->steps)
      if (!(steps.first + offset >= 0 && offset <= max_planes))
        refuse("a ray begins {} steps from its entry", steps.first + offset);
  }
  const Vec3 across = subtract(region.high, region.low);
  double most = 0;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t k = 0; k < 3; ++k) most += std::abs(steps.metric[3 * r + k] * across[k]);
  if (!(most <= max_planes)) refuse("rays of {} steps (at most {} are possible)", most, max_planes);
}

void validate_slice_segment(const VolumeDescription& volume, const RenderRequest& request) {
  const bool pairs = std::holds_alternative<PreIntegrationTable>(request.classification);
  if (pairs && !request.slice_segment) refuse("a pre-integration table needs segments");
  if (!pairs && request.slice_segment) refuse("segments need a pre-integration table");
  if (!pairs) return;
  if (request.steps) refuse("segments lie on planes, not on steps along rays");
  if (request.fog) refuse("there is no fog with segments");
  const SliceSegment& slice_segment = *request.slice_segment;
  if (!std::isfinite(slice_segment.planes) || !all_finite(slice_segment.offset) ||
      !all_finite(slice_segment.reach))
    refuse("the segments hold a value that is not finite");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = slice_segment.reach[axis] * volume.size[axis];
    if (!(cells >= 0 && cells <= volume.ghost_layer))
      refuse(
          "segments of {} texels along axis {} in a volume that was sent with a ghost layer of {}: send it "
          "again",
          cells, axis, volume.ghost_layer);
    if (volume.wrap[axis] == Wrap::repeat && cells > 0 &&
        (request.region.low[axis] - slice_segment.reach[axis] < 0 ||
         request.region.high[axis] + slice_segment.reach[axis] > 1))
      refuse("segments reach beyond a repeating texture along axis {}", axis);
  }
}

void validate_cut(const VolumeDescription& volume, int blocks) {
  if (blocks == 0) return;
  constexpr double most = 65536;
  double bricks = 1;
  for (const int texels : volume.size) bricks *= std::ceil(double(texels) / (blocks * BrickStore::block_cells));
  if (!(bricks <= most))
    refuse("segments are cut at {} bricks of {} cells (at most {} are possible): cut at larger ones", bricks,
           blocks * BrickStore::block_cells, most);
}

void validate_fog(const Fog& fog, Operator op) {
  if (op == Operator::min) refuse("there is no fog under the operator min");
  if (fog.entries.size() < 2 || fog.entries.size() > max_table_entries)
    refuse("the fog has {} entries (2 to {} are possible)", fog.entries.size(), max_table_entries);
  for (const Rgba& entry : fog.entries)
    if (!all_finite(entry)) refuse("the fog holds a value that is not finite");
  if (!all_finite(fog.normal) || !std::isfinite(fog.offset))
    refuse("the direction of the fog holds a value that is not finite");
}

}  // namespace

void validate(const VolumeDescription& volume, const RenderRequest& request) {
  if (!all_finite(request.texture_to_clip))
    refuse("the matrix from texture to clip space holds a value that is not finite");
  if (!inverse(request.texture_to_clip)) refuse("the matrix from texture to clip space is singular");
  if (!believable(request.viewport) || !believable(request.window) || request.viewport.empty())
    refuse("viewport of {} x {} pixels at ({}, {})", request.viewport.width, request.viewport.height,
           request.viewport.x, request.viewport.y);
  if (request.steps) validate_steps(*request.steps, request.region);
  const SlicePlanes& planes = request.planes;
  if (request.steps) {
    // They are not looked at.
  } else if (!all_finite(planes.normal) || !std::isfinite(planes.first) || !std::isfinite(planes.spacing))
    refuse("the slice planes hold a value that is not finite");
  if (!request.steps && !(length(planes.normal) > 0)) refuse("the slice planes have no direction");
  if (planes.count < 0 || planes.count > max_planes)
    refuse("{} slice planes (0 to {} are possible)", planes.count, max_planes);
  if (!all_finite(request.region.low) || !all_finite(request.region.high))
    refuse("the region of the slices holds a value that is not finite");
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double slack = 1e-6;
    if (volume.wrap[axis] == Wrap::repeat &&
        (request.region.low[axis] < -slack || request.region.high[axis] > 1 + slack))
      refuse("slices reach beyond a repeating texture along axis {} ({} to {})", axis, request.region.low[axis],
             request.region.high[axis]);
  }
  validate_cut(volume, request.cut_at_bricks);
  if (request.clip_planes.size() > max_clip_planes)
    refuse("{} clip planes (at most {} are possible)", request.clip_planes.size(), max_clip_planes);
  for (const HalfSpace& plane : request.clip_planes)
    if (!all_finite(plane.normal) || !std::isfinite(plane.offset))
      refuse("a clip plane holds a value that is not finite");
  if (!all_finite(request.depth_range)) refuse("the depth range holds a value that is not finite");
  if (!(request.termination >= 0 && request.termination < 1))
    refuse("termination threshold {} is outside [0, 1)", request.termination);
  if (request.depth &&
      (!believable(request.depth->rect) || request.depth->depth.size() != request.depth->rect.pixels()))
    refuse("the depth image holds {} values for {} x {} pixels", request.depth->depth.size(),
           request.depth->rect.width, request.depth->rect.height);
  validate_classification(volume, request.classification);
  validate_slice_segment(volume, request);
  if (request.fog) validate_fog(*request.fog, request.op);
  validate_segments(volume, request);
}

/// So many blocks away from its front the back of a segment may lie.
std::array<int, 3> blocks_in_reach(const VolumeDescription& volume,
                                   const std::optional<SliceSegment>& slice_segment) {
  std::array<int, 3> blocks{};
  for (std::size_t axis = 0; slice_segment && axis < 3; ++axis) {
    constexpr double rounding = 1e-2;  // of positions, in cells
    blocks[axis] =
        int(std::ceil((slice_segment->reach[axis] * volume.size[axis] + rounding) / BrickStore::block_cells));
  }
  return blocks;
}

/// The way from the first to the second sample, in the store's cells.
void set_slice_segment(const SliceSegment& slice_segment, Scene& scene) {
  const BrickStore& store = *scene.store;
  scene.samples_on = float(slice_segment.planes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    scene.cells_away[axis] = float(slice_segment.offset[axis] * store.description().size[axis]);
}

/// The places at which the store holds texels.
void set_held(Scene& scene) {
  const BrickStore& store = *scene.store;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto low = float(store.first_block()[axis] * BrickStore::block_cells);
    const float high = low + float(store.block_counts()[axis] * BrickStore::block_cells);
    scene.held_low[axis] = low;
    scene.held_high[axis] = std::min(scene.top[axis], std::nextafter(high, low));
  }
}

/// What the preparation of a request depends on beside its classification.
struct PreparedKey {
  bool keeps_clear_samples = false;  ///< under `min`
  std::array<int, 3> reach{};        ///< of segments, in blocks
  bool pre_integrated = false;
  float tolerance = 0;        ///< of adaptive steps, otherwise 0
  double step_cells = 0;      ///< their length
  bool skips = true;          ///< Optimizations::empty_bricks
  std::vector<float> levels;  ///< of surfaces, in units of the texel type

  bool operator==(const PreparedKey&) const = default;
};

PreparedKey prepared_key_of(const VolumeDescription& volume, const RenderRequest& request) {
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

/// What an image is drawn of, front to back.
struct Piece {
  RaySetup setup;
  Rect pixels;
};

/// All cells owned at once, or, where segments are cut, brick by brick.
std::vector<Piece> pieces_of(const RenderRequest& request, const BrickStore& store) {
  std::vector<Piece> pieces;
  const TexelBox& owned = store.owned_cells();
  if (request.cut_at_bricks != 0 && request.method == Method::pre_integrated) {
    const std::array<int, 3>& origin = store.lattice().origin;
    const BrickGrid grid =
        BrickGrid::covering(origin, owned.high, int(request.cut_at_bricks) * BrickStore::block_cells);
    for (const std::size_t brick : grid.in_visibility_order(store.description(), request)) {
      const TexelBox cells = intersection(grid.cells(brick), owned);
      if (is_empty(cells)) continue;
      const Rect pixels = footprint(request, store.description(), cells);
      if (!pixels.empty()) pieces.push_back({RaySetup(request, store, cells), pixels});
    }
  }
  if (pieces.empty()) pieces.push_back({RaySetup(request, store), request.window});
  return pieces;
}

void compose_behind(float* front, const float* back, int pixels) {
  for (int i = 0; i < pixels; ++i, front += 4, back += 4) {
    const float room = 1 - front[3];
    for (int k = 0; k < 4; ++k) front[k] += room * back[k];
  }
}

/// What stays the same from image to image while classification and prepared key do.
struct RayCaster::Prepared {
  Classification classification;
  PreparedKey prepared_key;
  std::optional<TransferTable> table;
  std::optional<PreIntegrationLookup> pairs;
  OccupancyMap skip;
  std::optional<std::vector<float>> bounds;  ///< made for the first maximum
  bool values_beyond = false;                ///< of the pre-integration table
  std::optional<PartTable> parts;            ///< these two of adaptive steps
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
      // A segment's far end may lie blocks away.
      skip = occupancy_map(store);
      return;
    }
    if (bounds && !bounds->empty())
      for (const std::size_t b : blocks) (*bounds)[b] = block_bound(store, *table, b);
    if (prepared_key.pre_integrated)
      values_beyond = values_beyond || std::any_of(blocks.begin(), blocks.end(),
                                                   [&](std::size_t b) { return lies_beyond(store, b); });
    // Distances reach far, but depend on nothing but which blocks show something.
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

RayCaster::RayCaster(const BrickStore& store) : store_(&store) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::blocks_changed(std::span<const std::size_t> blocks) {
  for (const auto& prepared : prepared_)
    if (prepared) prepared->blocks_changed(*store_, blocks);
}

void RayCaster::render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) {
  const BrickStore& store = *store_;
  if (!store.finished()) throw std::logic_error("rendering a volume whose slices have not all arrived");
  validate(store.description(), request);
  if (out.rgba.size() != 4 * out.rect.pixels())
    refuse("an image of {} x {} pixels with {} values", out.rect.width, out.rect.height, out.rgba.size());
  std::fill(out.rgba.begin(), out.rgba.end(), neutral_value(request.op));
  if (store.empty()) return;

  const PreparedKey prepared_key = prepared_key_of(store.description(), request);
  const auto fits = [&](const std::unique_ptr<Prepared>& prepared) {
    return prepared && prepared->prepared_key == prepared_key &&
           prepared->classification == request.classification;
  };
  if (!fits(prepared_[0])) prepared_[0].swap(prepared_[1]);
  if (!fits(prepared_[0]))
    prepared_[0] = std::make_unique<Prepared>(store, request.classification, prepared_key);
  const Prepared& prepared = *prepared_[0];
  counts.blocks += store.blocks();
  counts.blocks_empty += prepared.skip.empty_bricks();

  const Rect pixels = intersection(out.rect, intersection(request.window, request.viewport));
  if (pixels.empty() || (!request.steps && request.planes.count == 0)) return;

  const std::vector<Piece> pieces = pieces_of(request, store);
  const RaySetup& setup = pieces.front().setup;
  Scene scene;
  scene.store = &store;
  scene.skip = &prepared.skip;
  scene.table = prepared.table ? &*prepared.table : nullptr;
  scene.map = std::get_if<LinearMap>(&prepared.classification);
  std::optional<FogTable> fog;
  if (request.fog) fog.emplace(*request.fog, store);
  scene.fog = fog ? &*fog : nullptr;
  if (request.op == Operator::max && prepared.table && !request.fog &&
      request.optimizations.dominated_samples) {
    if (!prepared_[0]->bounds) prepared_[0]->bounds = block_bounds(store, *prepared.table);
    if (!prepared.bounds->empty()) scene.bounds = prepared.bounds->data();
  }
  scene.op = request.op;
  scene.filter = request.filter;
  scene.termination = request.termination;
  scene.top = setup.top;
  scene.rounding = setup.rounding;
  scene.pairs = prepared.pairs ? &*prepared.pairs : nullptr;
  scene.values_beyond = prepared.values_beyond;
  scene.parts = prepared.parts ? &*prepared.parts : nullptr;
  scene.division = prepared.division ? &*prepared.division : nullptr;
  set_held(scene);
  if (request.slice_segment) set_slice_segment(*request.slice_segment, scene);
  const SegmentScene segments(store.description(), request);
  if (walks_segments(request)) scene.segments = &segments;
  const Kernel kernel = scene.parts != nullptr      ? vector_adaptive
                        : scene.segments != nullptr ? vector_segments
                                                    : vector_kernel;
  for (std::size_t axis = 0; axis < 3; ++axis)
    scene.has_border[axis] = store.description().wrap[axis] == Wrap::border && request.filter == Filter::linear;

  tbb::combinable<FrameCounts> partial;
  const auto render_tile = [&](const Piece& piece, int x, int y, int width, int height, bool hidden) {
    FrameCounts& mine = partial.local();
    RayPacket packet;
    alignas(64) std::array<float, 4 * packet_rays> rgba;
    for (int row = 0; row < height; row += packet_height) {
      // Who waits for the image may have given it up: the loop below asks no more often than once a range.
      if (tbb::is_current_task_group_canceling()) return;
      const int rows = std::min(packet_height, height - row);
      if (!set_up_packet(piece.setup, request, x, y + row, width, rows, packet)) continue;
      for (std::size_t r = 0; r < packet_rays; ++r)
        if (packet.first[r] <= packet.last[r]) {
          ++mine.rays;
          const auto samples = std::uint64_t(packet.last[r] - packet.first[r] + 1);
          mine.samples += samples;
          if (hidden) mine.samples_hidden += samples;
        }
      if (hidden) continue;
      KernelCounts done;
      kernel(scene, packet, rgba.data(), done);
      mine.samples_taken += done.samples_taken;
      mine.rays_terminated += done.rays_terminated;
      mine.samples_hidden += done.samples_hidden;
      for (int r = 0; r < rows; ++r) {
        const float* const from = rgba.data() + 4 * r * tile_width;
        if (&piece == &pieces.front())
          std::copy_n(from, 4 * width, out.at(x, y + row + r));
        else
          compose_behind(out.at(x, y + row + r), from, width);
      }
    }
  };

  static_assert(tile_width == occlusion_tile);
  const Rect tiles = tiles_touched(pixels);
  if (!can_occlude(request)) occlusion = nullptr;
  const bool from_the_end = occlusion != nullptr && occlusion->from_the_end();
  tbb::parallel_for(
      tbb::blocked_range2d<int>(tiles.y, tiles.y + tiles.height, 1, tiles.x, tiles.x + tiles.width, 1),
      [&](const tbb::blocked_range2d<int>& range) {
        for (int row = range.rows().begin(); row < range.rows().end(); ++row)
          for (int column = range.cols().begin(); column < range.cols().end(); ++column) {
            const int at = from_the_end ? 2 * tiles.y + tiles.height - 1 - row : row;
            const Rect tile = intersection(
                pixels, {occlusion_tile * column, occlusion_tile * at, occlusion_tile, occlusion_tile});
            const bool hidden = occlusion != nullptr && occlusion->hides(tile);
            for (const Piece& piece : pieces)
              if (!intersection(piece.pixels, tile).empty())
                render_tile(piece, tile.x, tile.y, tile.width, tile.height, hidden);
            if (occlusion != nullptr && !hidden && is_opaque(out, tile, request)) occlusion->cover(tile);
          }
      });
  partial.combine_each([&](const FrameCounts& c) {
    counts.rays += c.rays;
    counts.rays_terminated += c.rays_terminated;
    counts.samples += c.samples;
    counts.samples_taken += c.samples_taken;
    counts.samples_hidden += c.samples_hidden;
    if (scene.bounds != nullptr) counts.dominated_samples += c.samples - c.samples_taken;
  });
}

void raycast(const BrickStore& store, const RenderRequest& request, Image& out, FrameCounts& counts) {
  RayCaster(store).render(request, out, counts);
}

}  // namespace understudy::volume
