// SPDX-License-Identifier: Apache-2.0
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

#include "volume/brick_grid.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/occlusion.h"
#include "volume/raycast/fog_table.h"
#include "volume/raycast/kernel.h"
#include "volume/raycast/prepared.h"
#include "volume/raycast/ray_setup.h"
#include "volume/raycast/segment_scene.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

/// Sets the offset from the first to the second sample, in the store's cells.
void set_slice_segment(const SliceSegment& slice_segment, Scene& scene) {
  const BrickStore& store = *scene.store;
  scene.samples_on = float(slice_segment.planes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    scene.cells_away[axis] = float(slice_segment.offset[axis] * store.description().size[axis]);
}

/// Sets the range of positions at which the store holds texels.
void set_held(Scene& scene) {
  const BrickStore& store = *scene.store;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto low = float(store.first_block()[axis] * BrickStore::block_cells);
    const float high = low + float(store.block_counts()[axis] * BrickStore::block_cells);
    scene.held_low[axis] = low;
    scene.held_high[axis] = std::min(scene.top[axis], std::nextafter(high, low));
  }
}

/// A part of the owned cells; an image is drawn from pieces, front to back.
struct Piece {
  RaySetup setup;
  Rect pixels;
};

/// All owned cells as one piece, or, where segments are cut at bricks, one piece per brick.
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

/// The inputs of kernels that depend on the request and the store, but not on the classification.
Scene scene_of(const RenderRequest& request, const BrickStore& store, const RaySetup& setup) {
  Scene scene;
  scene.store = &store;
  scene.op = request.op;
  scene.filter = request.filter;
  scene.termination = least_transparency(request);
  scene.opacity_limit = request.opacity_limit;
  scene.cover_whole_ray = request.steps && request.steps->cover_whole_ray;
  scene.top = setup.top;
  scene.rounding = setup.rounding;
  set_held(scene);
  if (request.slice_segment) set_slice_segment(*request.slice_segment, scene);
  for (std::size_t axis = 0; axis < 3; ++axis)
    scene.has_border[axis] = store.description().wrap[axis] == Wrap::border && request.filter == Filter::linear;
  return scene;
}

Kernel kernel_of(const Scene& scene) {
  if (scene.parts != nullptr) return vector_adaptive;
  return scene.segments != nullptr ? vector_segments : vector_kernel;
}

/// Renders one tile of one piece. The first piece (`first`) is written, others are composited behind the tile's
/// pixels. For a hidden tile, samples are only counted.
void render_tile(const Scene& scene, Kernel kernel, const RenderRequest& request, const Piece& piece,
                 bool first, const Rect& tile, bool hidden, Image& out, FrameCounts& mine) {
  RayPacket packet;
  alignas(64) std::array<float, 4 * packet_rays> rgba;
  for (int row = 0; row < tile.height; row += packet_height) {
    // The image may have been cancelled; the TBB loop that calls this checks only once per range.
    if (tbb::is_current_task_group_canceling()) return;
    const int rows = std::min(packet_height, tile.height - row);
    if (!set_up_packet(piece.setup, request, tile.x, tile.y + row, tile.width, rows, packet)) continue;
    for (std::size_t r = 0; r < packet_rays; ++r)
      if (packet.first[r] <= packet.last[r]) {
        ++mine.rays;
        const int samples = packet.last[r] - packet.first[r] + 1;
        mine.samples += std::uint64_t(samples);
        if (hidden) mine.samples_hidden += std::uint64_t(samples);
      }
    if (hidden) continue;
    KernelCounts done;
    kernel(scene, packet, rgba.data(), done);
    mine.samples_taken += done.samples_taken;
    mine.rays_terminated += done.rays_terminated;
    mine.samples_hidden += done.samples_hidden;
    for (int r = 0; r < rows; ++r) {
      const float* const from = rgba.data() + 4 * r * tile_width;
      if (first)
        std::copy_n(from, 4 * tile.width, out.at(tile.x, tile.y + row + r));
      else
        compose_behind(out.at(tile.x, tile.y + row + r), from, tile.width);
    }
  }
}

/// Renders all pixels, tile by tile on all cores. Returns the sum of the counts.
FrameCounts render_tiles(const Scene& scene, const RenderRequest& request, const std::vector<Piece>& pieces,
                         const Rect& pixels, Occlusion* occlusion, Image& out) {
  const Kernel kernel = kernel_of(scene);
  tbb::combinable<FrameCounts> partial;
  static_assert(tile_width == occlusion_tile);
  const Rect tiles = tiles_touched(pixels);
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
                render_tile(scene, kernel, request, piece, &piece == &pieces.front(), tile, hidden, out,
                            partial.local());
            if (occlusion != nullptr && !hidden && is_opaque(out, tile, request)) occlusion->cover(tile);
          }
      });
  FrameCounts sum;
  partial.combine_each([&](const FrameCounts& c) { sum += c; });
  return sum;
}

/// Pixel spacing of the rays that are cast for an estimate.
constexpr int estimate_spacing = 8;
constexpr int estimate_spacing_bits = 3;
/// Cost of setting up a ray, in samples (docs/scaling.md: 42 and 3 ns).
constexpr float samples_per_ray = 14;

/// Estimates the cost of one tile from some of the rays through it.
float estimated_cost(const Scene& scene, Kernel kernel, const RenderRequest& request, const RaySetup& spread,
                     const Rect& tile) {
  RayPacket packet;
  alignas(64) std::array<float, 4 * packet_rays> rgba;
  KernelCounts done;
  int rays = 0;
  // Rays whose pixels lie in the tile. The shift in `first` rounds down, unlike a division.
  static_assert(estimate_spacing == 1 << estimate_spacing_bits);
  const auto first = [](int low) { return (low + estimate_spacing / 2 - 1) >> estimate_spacing_bits; };
  const int left = first(tile.x), right = first(tile.x + tile.width);
  const int bottom = first(tile.y), top = first(tile.y + tile.height);
  for (int y = bottom; y < top; y += packet_height)
    for (int x = left; x < right; x += tile_width) {
      if (!set_up_packet(spread, request, x, y, std::min(tile_width, right - x),
                         std::min(packet_height, top - y), packet))
        continue;
      for (std::size_t r = 0; r < packet_rays; ++r) rays += packet.first[r] <= packet.last[r] ? 1 : 0;
      kernel(scene, packet, rgba.data(), done);
    }
  const int cast = (right - left) * (top - bottom);
  if (cast <= 0) return 0;
  return (float(done.samples_taken) + samples_per_ray * float(rays)) * float(tile.pixels()) / float(cast);
}

}  // namespace

RayCaster::RayCaster(const BrickStore& store) : store_(&store) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::blocks_changed(std::span<const std::size_t> blocks) {
  for (const auto& prepared : prepared_)
    if (prepared) prepared->blocks_changed(*store_, blocks);
}

RayCaster::Prepared& RayCaster::prepare(const RenderRequest& request) {
  const PreparedKey prepared_key = prepared_key_of(store_->description(), request);
  const auto fits = [&](const std::unique_ptr<Prepared>& prepared) {
    return prepared && prepared->prepared_key == prepared_key &&
           prepared->classification == request.classification;
  };
  if (!fits(prepared_[0])) prepared_[0].swap(prepared_[1]);
  if (!fits(prepared_[0]))
    prepared_[0] = std::make_unique<Prepared>(*store_, request.classification, prepared_key);
  return *prepared_[0];
}

void RayCaster::render(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) {
  const BrickStore& store = *store_;
  if (!store.finished()) throw std::logic_error("rendering a volume whose slices have not all arrived");
  validate(store.description(), request);
  if (out.rgba.size() != 4 * out.rect.pixels())
    throw std::invalid_argument(fmt::format("an image of {} x {} pixels with {} values", out.rect.width,
                                            out.rect.height, out.rgba.size()));
  std::fill(out.rgba.begin(), out.rgba.end(), neutral_value(request.op));
  if (store.empty()) return;

  Prepared& prepared = prepare(request);
  counts.blocks += store.blocks();
  counts.blocks_empty += prepared.skip.empty_bricks();

  const Rect pixels = intersection(out.rect, intersection(request.window, request.viewport));
  if (pixels.empty() || (!request.steps && request.planes.count == 0)) return;

  const std::vector<Piece> pieces = pieces_of(request, store);
  Scene scene = scene_of(request, store, pieces.front().setup);
  prepared.complete(scene, request, store);
  std::optional<FogTable> fog;
  if (request.fog) scene.fog = &fog.emplace(*request.fog, store);
  const SegmentScene segments(store.description(), request);
  if (walks_segments(request)) scene.segments = &segments;
  const FrameCounts drawn =
      render_tiles(scene, request, pieces, pixels, can_occlude(request) ? occlusion : nullptr, out);
  counts.rays += drawn.rays;
  counts.rays_terminated += drawn.rays_terminated;
  counts.samples += drawn.samples;
  counts.samples_taken += drawn.samples_taken;
  counts.samples_hidden += drawn.samples_hidden;
  if (scene.bounds != nullptr) counts.dominated_samples += drawn.samples - drawn.samples_taken;
}

void RayCaster::estimate_costs(const RenderRequest& request, std::span<const Rect> tiles,
                               std::span<float> costs) {
  const BrickStore& store = *store_;
  if (!store.finished()) throw std::logic_error("rendering a volume whose slices have not all arrived");
  validate(store.description(), request);
  std::ranges::fill(costs, 0.0F);
  if (store.empty() || (!request.steps && request.planes.count == 0)) return;
  Prepared& prepared = prepare(request);
  RaySetup spread(request, store);
  Scene scene = scene_of(request, store, spread);
  spread.spread(estimate_spacing);
  prepared.complete(scene, request, store);
  std::optional<FogTable> fog;
  if (request.fog) scene.fog = &fog.emplace(*request.fog, store);
  const SegmentScene segments(store.description(), request);
  if (walks_segments(request)) scene.segments = &segments;
  const Kernel kernel = kernel_of(scene);
  tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t i) {
    costs[i] = estimated_cost(scene, kernel, request, spread, tiles[i]);
  });
}

void raycast(const BrickStore& store, const RenderRequest& request, Image& out, FrameCounts& counts) {
  RayCaster(store).render(request, out, counts);
}

}  // namespace understudy::volume
