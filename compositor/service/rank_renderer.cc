// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/rank_renderer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>
#include <utility>

#include "compositor/crop.h"
#include "compositor/service.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/limits.h"
#include "compositor/service/time_limit.h"
#include "volume/brick/brick_store.h"
#include "volume/brick/histogram.h"
#include "volume/cell_lattice.h"
#include "volume/error_bound/error_bound.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/kd_tree.h"
#include "volume/matrix.h"
#include "volume/occlusion.h"
#include "volume/raycast/brick_renderer.h"
#include "volume/raycast/ray_caster.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::compositor {

using namespace volume;

struct RankRenderer::Volume {
  Arrangement arrangement;
  Arrangement::Place place;
  KdTree tree;  ///< divides the volume among the members of a group
  BrickStore bricks;
  std::unique_ptr<BrickRenderer> renderer;
  ErrorBoundRenderer bounds;
  std::vector<TexelBox> shown;  ///< by member
  enum class State { filling, complete, changing } state = State::filling;
  std::uint64_t version;
  std::vector<std::size_t> changed_blocks;
  bool keeps_bricks;         ///< otherwise it reads another rank's
  std::string bricks_path;   ///< of that rank's bricks
  bool bricks_read = false;  ///< in their present version

  Volume(const VolumeDescription& description, int rank, const Arrangement& arranged, PartitionMethod method,
         const BrickRendererFactory& make_renderer)
      : arrangement(arranged),
        place(arrangement.place(rank)),
        tree(description, initial_partition(description, arrangement.members(), method)),
        bricks(description, tree.box(place.member)),
        renderer(make_renderer(bricks)),
        bounds(bricks),
        version(description.version),
        keeps_bricks(place.keeper == rank) {
    if (keeps_bricks && arrangement.readers(rank) > 1) bricks.share();
    find_shown();
  }

  void find_shown() {
    shown.clear();
    for (int member = 0; member < tree.ranks(); ++member)
      shown.push_back(BrickStore::texels_shown(bricks.description(), tree.box(member)));
  }

  /// To be called when all texels have arrived at the rank that keeps them.
  void complete() {
    if (keeps_bricks) {
      if (!bricks.finished()) bricks.finish();
      bricks.publish();
      take_changes();
    }
    bricks_read = keeps_bricks;
    state = State::complete;
  }

  void take_changes() {
    renderer->blocks_changed(changed_blocks);
    bounds.blocks_changed(changed_blocks);
    changed_blocks.clear();
  }

  void read_bricks() {
    bricks.read_blocks_of(bricks_path);
    take_changes();
    bricks_read = true;
  }
};

namespace {

// Far below any tolerance in use, and far above one that takes endless time.
constexpr double integral_tolerance = 1e-7;

// Turns exceptions of the module `volume` about its arguments into refusals, and lack of memory, too.
template <class Call>
auto refusing(Call call) {
  try {
    return call();
  } catch (const std::invalid_argument& error) {
    throw RequestRefused(error.what());
  } catch (const std::bad_alloc&) {
    throw RequestRefused("out of memory: use more nodes or a smaller volume");
  }
}

/// Returns the bytes of the texels that the ranks keep.
std::uint64_t stored_bytes(const VolumeDescription& description) {
  const TexelBox kept =
      description.part ? BrickStore::texels_shown(description, shown_cells(description)) : description.stored;
  return texels_in(kept) * bytes_per_texel(description.type);
}

/// Returns a rank's share of the stored texels; bricks that ranks of one machine share are divided among them.
std::uint64_t share_of(const VolumeDescription& description, const Arrangement& arrangement, int rank) {
  const int readers = arrangement.readers(arrangement.place(rank).keeper);
  return stored_bytes(description) / std::uint64_t(arrangement.members()) / std::uint64_t(readers);
}

void keep_limits_of_one(const VolumeDescription& description) {
  std::array<std::uint64_t, 3> stored{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t extent = std::int64_t(description.stored.high[axis]) - description.stored.low[axis];
    if (extent <= 0 || extent > max_axis_texels)
      throw RequestRefused(fmt::format("volume {} stores {} texels along axis {}, not 1 to {}", description.id,
                                       extent, axis, max_axis_texels));
    stored[axis] = std::uint64_t(extent);
  }
  const std::uint64_t slice = stored[0] * stored[1] * bytes_per_texel(description.type);
  if (slice > limits::max_slice_bytes || slice * stored[2] > limits::max_volume_bytes)
    throw RequestRefused(fmt::format(
        "volume {} of {} x {} x {} texels is over the limit of {} MiB a slice or {} GiB", description.id,
        stored[0], stored[1], stored[2], limits::max_slice_bytes >> 20, limits::max_volume_bytes >> 30));
  refusing([&] { return shown_cells(description); });
}

/// Returns the most samples that an image can have.
double most_samples(const RenderRequest& request) {
  double a_ray = request.planes.count;
  if (request.steps) {
    const Vec3 across = subtract(request.region.high, request.region.low);
    a_ray = 1;
    for (std::size_t i = 0; i < 9; ++i) a_ray += std::abs(request.steps->metric[i] * across[i % 3]);
  }
  constexpr double most_parts = 16;
  if (request.method == Method::adaptive) a_ray *= most_parts;
  return a_ray * double(intersection(request.window, request.viewport).pixels());
}

void refuse_excess(const RenderRequest& request) {
  if (const double samples = most_samples(request); samples > double(limits::max_image_samples))
    throw RequestRefused(fmt::format(
        "an image of up to {:.3g} samples is over the limit of {:.3g} of these nodes: ask for fewer "
        "pixels, or for fewer samples along a ray",
        samples, double(limits::max_image_samples)));
}

}  // namespace

RankRenderer::RankRenderer(int rank, int ranks, BrickRendererFactory make_renderer, const ClientLimits& limits)
    : RankRenderer(rank, std::vector<int>(std::size_t(ranks)), std::move(make_renderer), limits, {}) {}
RankRenderer::RankRenderer(int rank, std::vector<int> machines, BrickRendererFactory make_renderer,
                           const ClientLimits& limits, const SortSettings& sort)
    : rank_(rank),
      machines_(std::move(machines)),
      make_renderer_(std::move(make_renderer)),
      limits_(limits),
      sort_(sort) {}
RankRenderer::~RankRenderer() = default;

RankRenderer::Volume& RankRenderer::find(VolumeKey key) const {
  const auto found = volumes_.find(key);
  if (found == volumes_.end()) throw RequestRefused(fmt::format("volume {} is not known here", key.volume));
  return *found->second;
}

RankRenderer::Volume& RankRenderer::find_complete(std::uint64_t client, const RenderRequest& request) const {
  Volume& volume = find({client, request.volume});
  if (volume.state != Volume::State::complete)
    throw RequestRefused(fmt::format("volume {} is not complete yet", request.volume));
  if (volume.version != request.version)
    throw RequestRefused(fmt::format("volume {} is here in version {}, not {}", request.volume, volume.version,
                                     request.version));
  if (!volume.bricks_read) {
    try {
      volume.read_bricks();
    } catch (const std::exception& error) {
      throw RequestRefused(fmt::format("rank {} cannot read the bricks of rank {}: {}; use --sort last", rank_,
                                       volume.place.keeper, error.what()));
    }
  }
  return volume;
}

Arrangement RankRenderer::arranged(VolumeKey key, const VolumeDescription& description) const {
  // Subtracts what other volumes take of a machine; all ranks compute the same.
  SortSettings sort = sort_;
  // Parts are chosen as large as all ranks together have room for.
  if (description.part) sort.sort = Sort::last;
  for (const auto& [held, volume] : volumes_) {
    if (held == key) continue;  // it is replaced
    const std::uint64_t of_machine =
        stored_bytes(volume->bricks.description()) / std::uint64_t(volume->arrangement.members());
    sort.bytes_of_machine -= std::min(sort.bytes_of_machine, of_machine);
  }
  return {sort, machines_, stored_bytes(description)};
}

// Checked early: memory that is promised but missing ends in a killed process, not in an exception.
void RankRenderer::keep_limits(VolumeKey key, const VolumeDescription& description) const {
  std::uint64_t in_all = 0;
  std::uint64_t of_client = 0;
  for (const auto& [held, volume] : volumes_) {
    if (held == key) continue;  // it is replaced
    const std::uint64_t share = share_of(volume->bricks.description(), volume->arrangement, rank_);
    in_all += share;
    if (held.client == key.client) of_client += share;
  }
  const std::uint64_t share = share_of(description, arranged(key, description), rank_);
  if (of_client + share > limits_.bytes_of_client)
    throw RequestRefused(
        fmt::format("a node's share of volume {} is {} MiB, and of this client it holds {} MiB and may hold {} "
                    "MiB: use more "
                    "nodes, or forget a volume first",
                    description.id, share >> 20, of_client >> 20, limits_.bytes_of_client >> 20));
  if (in_all + share > limits_.bytes_in_all)
    throw RequestRefused(fmt::format(
        "a node's share of volume {} is {} MiB, and it holds {} MiB for all its clients and may hold {} MiB: "
        "use more nodes, or try again when others have gone",
        description.id, share >> 20, in_all >> 20, limits_.bytes_in_all >> 20));
}

void RankRenderer::begin(std::uint64_t client, const VolumeDescription& description) {
  keep_limits_of_one(description);
  const VolumeKey key{client, description.id};
  keep_limits(key, description);
  const auto held =
      std::ranges::count_if(volumes_, [&](const auto& entry) { return entry.first.client == client; });
  if (!volumes_.contains(key) && std::size_t(held) >= limits::max_volumes_per_client)
    throw RequestRefused(fmt::format("{} volumes are held already: forget one first", held));
  // The old volume is freed first: two versions of a large volume need not fit side by side.
  volumes_.erase(key);
  refusing([&] {
    volumes_.emplace(key, std::make_unique<Volume>(description, rank_, arranged(key, description),
                                                   sort_.partition, make_renderer_));
  });
}

void RankRenderer::begin_change(VolumeKey key, std::uint64_t version) {
  Volume& volume = find(key);
  if (volume.state != Volume::State::complete)
    throw RequestRefused(fmt::format("volume {} cannot change before it is complete", key.volume));
  volume.state = Volume::State::changing;
  volume.version = version;
}

void RankRenderer::check_texels(VolumeKey key, std::span<const TexelBox> boxes, std::size_t bytes) const {
  const Volume& volume = find(key);
  if (volume.state == Volume::State::complete)
    throw RequestRefused(fmt::format("volume {} is complete: begin a change", key.volume));
  const TexelBox& stored = volume.bricks.description().stored;
  std::size_t texels = 0;
  for (const TexelBox& box : boxes) {
    const bool slice_range = box.low[0] == stored.low[0] && box.low[1] == stored.low[1] &&
                             box.high[0] == stored.high[0] && box.high[1] == stored.high[1];
    if (is_empty(box) || !contains(stored, box) || (volume.state == Volume::State::filling && !slice_range))
      throw RequestRefused(fmt::format("texels ({}, {}, {}) to ({}, {}, {}) are no {} of volume {}", box.low[0],
                                       box.low[1], box.low[2], box.high[0], box.high[1], box.high[2],
                                       slice_range || !contains(stored, box) ? "part" : "slice range",
                                       key.volume));
    texels += texels_in(box);
  }
  if (const std::size_t expected = texels * bytes_per_texel(key); bytes != expected)
    throw RequestRefused(
        fmt::format("volume {}: {} bytes of texels instead of {}", key.volume, bytes, expected));
}

std::vector<TexelBox> RankRenderer::shares(VolumeKey key, std::span<const TexelBox> boxes, int rank) const {
  const Volume& volume = find(key);
  const Arrangement::Place& place = volume.arrangement.place(rank);
  std::vector<TexelBox> shares;
  if (place.keeper != rank) return shares;
  for (const TexelBox& box : boxes)
    if (const TexelBox share = intersection(box, volume.shown[std::size_t(place.member)]); !is_empty(share))
      shares.push_back(share);
  return shares;
}

void RankRenderer::add_texels(VolumeKey key, std::span<const TexelBox> shares,
                              std::span<const std::byte> texels) {
  Volume& volume = find(key);
  if (volume.state == Volume::State::complete)
    throw RequestRefused(fmt::format("volume {} is complete: begin a change", key.volume));
  refusing([&] {
    for (const TexelBox& share : shares) {
      const std::size_t bytes = texels_in(share) * bytes_per_texel(key);
      if (volume.state == Volume::State::filling)
        volume.bricks.add_slices(share, texels.first(bytes));
      else
        volume.bricks.change(share, texels.first(bytes), volume.changed_blocks);
      texels = texels.subspan(bytes);
    }
  });
}

void RankRenderer::texels_change(VolumeKey key, std::span<const TexelBox> boxes) {
  Volume& volume = find(key);
  // The keeper of the bricks finds the changed blocks when it writes them.
  if (volume.keeps_bricks || volume.state != Volume::State::changing) return;
  refusing([&] {
    std::vector<std::size_t>& changed = volume.changed_blocks;
    for (const TexelBox& box : boxes) {
      const std::vector<std::size_t> blocks = volume.bricks.blocks_that_show(box);
      changed.insert(changed.end(), blocks.begin(), blocks.end());
      if (changed.size() <= volume.bricks.blocks()) continue;
      std::ranges::sort(changed);
      changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    }
  });
}

std::size_t RankRenderer::bytes_per_texel(VolumeKey key) const {
  return volume::bytes_per_texel(find(key).bricks.description().type);
}

const VolumeDescription& RankRenderer::description(VolumeKey key) const {
  return find(key).bricks.description();
}

std::size_t RankRenderer::bytes(VolumeKey key) const {
  return find(key).bricks.bytes();
}

const TexelBox& RankRenderer::cells(VolumeKey key) const {
  const Volume& volume = find(key);
  return volume.tree.box(volume.place.member);
}

const Arrangement& RankRenderer::arrangement(VolumeKey key) const {
  return find(key).arrangement;
}

int RankRenderer::shared_descriptor(VolumeKey key) const {
  return find(key).bricks.shared_descriptor();
}

void RankRenderer::find_bricks_at(VolumeKey key, const std::string& path) {
  find(key).bricks_path = path;
}

std::vector<std::uint64_t> RankRenderer::histogram(VolumeKey key, const HistogramBins& bins) const {
  const Volume& volume = find(key);
  if (volume.state != Volume::State::complete)
    throw RequestRefused(fmt::format("volume {} is not complete yet", key.volume));
  if (volume.place.group > 0) return std::vector<std::uint64_t>(std::size_t(bins.count));
  return refusing([&] { return volume::histogram(volume.bricks, bins); });
}

void RankRenderer::end(VolumeKey key) {
  Volume& volume = find(key);
  refusing([&] { volume.complete(); });
}

void RankRenderer::forget(VolumeKey key) {
  volumes_.erase(key);
}

void RankRenderer::forget_client(std::uint64_t client) {
  std::erase_if(volumes_, [&](const auto& entry) { return entry.first.client == client; });
}

void RankRenderer::begin_image() {
  if (limits_.image_time.count() > 0) image_until_ = Clock::now() + limits_.image_time;
}

void RankRenderer::within_time(Volume& volume, const std::function<void()>& work) {
  if (!image_until_) return work();
  if (done_until(*image_until_, work)) return;
  // Its prepared classification may be incomplete.
  volume.renderer = make_renderer_(volume.bricks);
  volume.bounds = ErrorBoundRenderer(volume.bricks);
  throw RequestRefused(
      fmt::format("an image took longer than {} ms, the limit of these nodes: ask for fewer pixels or samples, "
                  "or use more nodes",
                  limits_.image_time.count()));
}

void RankRenderer::keep_image_limits(const RenderRequest& request) const {
  if (request.window.pixels() > limits::max_window_pixels)
    throw RequestRefused(fmt::format("an image of {} pixels is over the limit of {}", request.window.pixels(),
                                     limits::max_window_pixels));
  if (image_until_) refuse_excess(request);
}

Image RankRenderer::render(std::uint64_t client, const RenderRequest& request, FrameCounts& counts,
                           Occlusion* occlusion, const std::optional<Rect>& part) {
  const auto start = std::chrono::steady_clock::now();
  Volume& volume = find_complete(client, request);
  Image image = refusing([&] {
    const VolumeDescription& description = volume.bricks.description();
    validate(description, request);
    keep_image_limits(request);  // before memory is allocated
    const Rect everything = request.optimizations.footprints
                                ? footprint(request, description, volume.tree.box(volume.place.member))
                                : intersection(request.window, request.viewport);
    Image result(part ? intersection(everything, *part) : everything);
    FrameCounts here;
    BrickRenderer& renderer = request.bound_of ? volume.bounds : *volume.renderer;
    within_time(volume, [&] { renderer.render(request, result, here, occlusion); });
    // The bricks of the first group are the whole volume.
    if (volume.place.group > 0) here.blocks = here.blocks_empty = 0;
    counts += here;
    return result;
  });
  if (request.optimizations.footprints) crop_to_content(image, request.op);
  counts.render_ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return image;
}

std::vector<float> RankRenderer::estimated_costs(std::uint64_t client, const RenderRequest& request,
                                                 std::span<const Rect> tiles) {
  Volume& volume = find_complete(client, request);
  return refusing([&] {
    keep_image_limits(request);
    std::vector<float> costs(tiles.size());
    within_time(volume, [&] { volume.renderer->estimate_costs(request, tiles, costs); });
    return costs;
  });
}

std::vector<IntegralPart> RankRenderer::integrals(std::uint64_t client, const RenderRequest& request,
                                                  std::span<const Pixel> pixels, double most_ms) const {
  const auto start = std::chrono::steady_clock::now();
  const Volume& volume = find_complete(client, request);
  return refusing([&] {
    validate(volume.bricks.description(), request);
    const auto* const function = std::get_if<TransferFunction>(&request.classification);
    if (!request.steps || function == nullptr || request.op != Operator::over ||
        request.filter != Filter::linear || request.fog)
      throw RequestRefused(
          "integrals are of requests on steps, under over with a transfer function, a linear filter and no "
          "fog");
    const Medium medium = Medium::of_samples(*function, 1);
    std::vector<IntegralPart> parts(pixels.size());
    std::size_t done = 0;
    const auto groups = std::size_t(volume.arrangement.groups());
    const std::size_t at_once = groups * std::size_t(std::max(1, tbb::this_task_arena::max_concurrency()));
    while (done < pixels.size()) {
      const std::size_t end = std::min(done + at_once, pixels.size());
      tbb::parallel_for(done, end, [&](std::size_t i) {
        if (i % groups != std::size_t(volume.place.group)) return;
        const RayIntegral seen =
            stored_pixel_integral(volume.bricks, request, medium, pixels[i].x, pixels[i].y, integral_tolerance);
        parts[i] = {seen.colour, seen.optical_depth};
      });
      done = end;
      const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
      if (spent.count() >= most_ms) break;
    }
    parts.resize(done);
    return parts;
  });
}

std::vector<Rect> RankRenderer::footprints(std::uint64_t client, const RenderRequest& request) const {
  const Volume& volume = find_complete(client, request);
  return refusing([&] {
    validate(volume.bricks.description(), request);
    if (volume::needs_whole_rays(request) && volume.arrangement.members() > 1)
      throw RequestRefused(
          fmt::format("rays that end where they are opaque to {} have to be cast whole: let ranks divide the "
                      "image alone (--sort first)",
                      request.opacity_limit));
    std::vector<Rect> of_member;
    of_member.reserve(std::size_t(volume.arrangement.members()));
    for (int member = 0; member < volume.arrangement.members(); ++member)
      of_member.push_back(footprint(request, volume.bricks.description(), volume.tree.box(member)));
    std::vector<Rect> result;
    result.reserve(machines_.size());
    for (int rank = 0; rank < ranks(); ++rank)
      result.push_back(of_member[std::size_t(volume.arrangement.place(rank).member)]);
    return result;
  });
}

const Partition& RankRenderer::partition(std::uint64_t client, const RenderRequest& request) const {
  return find_complete(client, request).tree.partition();
}

const BrickStore& RankRenderer::bricks(std::uint64_t client, const RenderRequest& request) const {
  const BrickStore& bricks = find_complete(client, request).bricks;
  refusing([&] { validate(bricks.description(), request); });
  return bricks;
}

void RankRenderer::divide(
    VolumeKey key, const Partition& partition,
    const std::function<std::vector<std::byte>(const std::array<int, 3>& place)>& packed_block) {
  Volume& volume = find(key);
  KdTree tree(volume.bricks.description(), partition);
  if (tree.box(rank_) == volume.tree.box(rank_)) {
    volume.tree = std::move(tree);
    volume.find_shown();
    return;
  }
  // The renderer keeps data of blocks that are about to move; it is freed first, to make room.
  volume.renderer.reset();
  volume.bricks.reshape(tree.box(rank_), packed_block);
  volume.renderer = make_renderer_(volume.bricks);
  volume.bounds = ErrorBoundRenderer(volume.bricks);
  volume.tree = std::move(tree);
  volume.find_shown();
}

std::vector<int> RankRenderer::visibility_order(std::uint64_t client, const RenderRequest& request) const {
  const Volume& volume = find_complete(client, request);
  return refusing([&] {
    const std::vector<int> members = volume.tree.visibility_order(request);
    // Groups show different pixels, so their order does not matter.
    std::vector<int> order;
    order.reserve(machines_.size());
    for (int group = 0; group < volume.arrangement.groups(); ++group)
      for (const int member : members) order.push_back(volume.arrangement.rank_at(group, member));
    return order;
  });
}

}  // namespace understudy::compositor
