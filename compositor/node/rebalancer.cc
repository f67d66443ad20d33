// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/rebalancer.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "compositor/balance/moves.h"
#include "compositor/node/image_division.h"
#include "volume/cell_lattice.h"
#include "volume/raycast/expected_samples.h"
#include "volume/request.h"

namespace understudy::compositor {

using volume::BlockCosts;
using volume::BrickStore;
using volume::Partition;
using volume::TexelBox;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_cubes = std::size_t(1) << 15;  // 128 KiB of costs are sent before an image

/// Returns the edge of the smallest cubes of which there are at most most_cubes.
int cost_edge(const TexelBox& lattice) {
  for (int edge = BrickStore::block_cells;; edge *= 2) {
    std::size_t cubes = 1;
    for (std::size_t k = 0; k < 3; ++k)
      cubes *= std::size_t((lattice.high[k] - lattice.low[k] + edge - 1) / edge);
    if (cubes <= most_cubes) return edge;
  }
}

/// Returns the cubes in which blocks of these cells lie.
TexelBox cubes_touched(const BlockCosts& costs, const TexelBox& cells) {
  if (volume::is_empty(cells)) return {};
  TexelBox cubes;
  for (std::size_t k = 0; k < 3; ++k) {
    cubes.low[k] = (cells.low[k] - costs.lattice().low[k]) / costs.edge();
    cubes.high[k] = (cells.high[k] - 1 - costs.lattice().low[k]) / costs.edge() + 1;
  }
  return cubes;
}

template <class Visit>
void for_each_place(const TexelBox& box, const Visit& visit) {
  for (int z = box.low[2]; z < box.high[2]; ++z)
    for (int y = box.low[1]; y < box.high[1]; ++y)
      for (int x = box.low[0]; x < box.high[0]; ++x) visit(BlockPlace{x, y, z});
}

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::optional<double> deviation(std::span<const RankWork> work) {
  if (work.empty()) return std::nullopt;
  double least = work[0].ms, most = work[0].ms, sum = 0;
  for (const RankWork& rank : work) {
    least = std::min(least, rank.ms);
    most = std::max(most, rank.ms);
    sum += rank.ms;
  }
  return sum > 0 ? (most - least) * double(work.size()) / sum : 0;
}

}  // namespace

Rebalancer::Rebalancer(Communicator& communicator, RankRenderer& renderer, BalanceSettings settings,
                       volume::PartitionMethod method)
    : communicator_(communicator), renderer_(renderer), settings_(std::move(settings)), method_(method) {}

Rebalancer::Appearance Rebalancer::appearance(const volume::RenderRequest& request) {
  return {request.op, request.classification, request.surfaces, request.clip_planes, request.region};
}

/// Whether a volume's partition may change for this image. Balancing by measured times considers every image;
/// cutting by expected costs alone considers another appearance, and every few images, as the camera moves.
bool Rebalancer::is_due(const Volume& volume, const volume::RenderRequest& request) const {
  constexpr int images_between = 8;
  return settings_.balance != Balance::off || volume.images_since >= images_between ||
         volume.cut_for != appearance(request);
}

/// What one rank can determine alone, and may fail to: the request, and what this rank expects it to cost.
struct Rebalancer::Expected {
  std::optional<volume::RenderRequest> request;
  Volume* volume = nullptr;
  bool due = false;  ///< if not, the following are empty
  std::vector<TexelBox> boxes;
  std::optional<BlockCosts> costs;
  std::vector<float> mine, all;          ///< of the cubes that each rank's box touches
  std::size_t most_here = 0;             ///< blocks, if the ranks have not exchanged these yet
  std::vector<std::size_t> most_blocks;  ///< space for the values of all ranks
};

Rebalancer::Volume Rebalancer::new_volume() const {
  return {.balancer = make_balancer(settings_.balance, method_),
          .given_away = BlockCache(settings_.cache_bytes),
          .work = {},
          .ms_per_block = 0,
          .most_blocks = {},
          .cut_for = {}};
}

Rebalancer::Volume& Rebalancer::volume_of(VolumeKey key) {
  auto known = volumes_.find(key);
  if (known == volumes_.end()) known = volumes_.emplace(key, new_volume()).first;
  return known->second;
}

void Rebalancer::begin(VolumeKey key) {
  const auto known = volumes_.find(key);
  if (known == volumes_.end()) return;
  Volume volume = new_volume();
  // Cutting uses the samples of all ranks together, whatever their boxes were.
  if (method_ == volume::PartitionMethod::cost) volume.work = std::move(known->second.work);
  volume.ms_per_block = known->second.ms_per_block;
  known->second = std::move(volume);
}

void Rebalancer::expect(std::uint64_t client, const std::function<volume::RenderRequest()>& decode,
                        Expected& expected) {
  const volume::RenderRequest& request = expected.request.emplace(decode());
  const BrickStore& bricks = renderer_.bricks(client, request);
  const TexelBox lattice = bricks.lattice().box();
  expected.volume = &volume_of({client, request.volume});
  // A part of a volume is shown once, and then replaced.
  expected.due = !bricks.description().part && is_due(*expected.volume, request);
  if (!expected.due) return;
  expected.boxes = volume::boxes(renderer_.partition(client, request), bricks.description());
  BlockCosts& costs = expected.costs.emplace(lattice, cost_edge(lattice));
  volume::add_expected_samples(bricks, request, costs);
  std::size_t most = 0;
  for (const TexelBox& box : expected.boxes)
    most = std::max(most, volume::texels_in(cubes_touched(costs, box)));
  if (expected.volume->most_blocks.empty()) {
    expected.most_here = most_blocks_here(bricks);
    expected.most_blocks.resize(expected.boxes.size());
  }
  expected.mine.resize(most);
  expected.all.resize(most * expected.boxes.size());
  std::size_t next = 0;
  for_each_place(
      cubes_touched(costs, expected.boxes[std::size_t(communicator_.rank())]),
      [&](const BlockPlace& cube) { expected.mine[next++] = float(costs.values()[costs.index(cube)]); });
}

/// Exchanges the ranks' expectations: `costs` then holds those of the whole image.
void Rebalancer::gather_costs(Expected& expected) {
  if (expected.volume->most_blocks.empty()) {
    communicator_.gather_to_all(bytes_of(expected.most_here),
                                std::as_writable_bytes(std::span(expected.most_blocks)));
    expected.volume->most_blocks = std::move(expected.most_blocks);
  }
  communicator_.gather_to_all(std::as_bytes(std::span(expected.mine)),
                              std::as_writable_bytes(std::span(expected.all)));
  BlockCosts& costs = *expected.costs;
  std::ranges::fill(costs.values(), 0.0);
  for (std::size_t rank = 0; rank < expected.boxes.size(); ++rank) {
    const float* value = expected.all.data() + rank * expected.mine.size();
    for_each_place(cubes_touched(costs, expected.boxes[rank]),
                   [&](const BlockPlace& cube) { costs.values()[costs.index(cube)] += double(*value++); });
  }
}

volume::RenderRequest Rebalancer::before_image(std::uint64_t client,
                                               const std::function<volume::RenderRequest()>& decode) {
  // Nothing that may fail on one rank alone may stand between two collective calls.
  Expected expected;
  std::exception_ptr trouble;
  try {
    expect(client, decode, expected);
  } catch (...) {
    trouble = std::current_exception();
  }
  const bool agreed = all_agree(communicator_, trouble == nullptr);
  if (trouble) std::rethrow_exception(trouble);
  if (!agreed) return std::move(*expected.request);  // another rank refuses it
  ++expected.volume->images_since;
  if (!expected.due) return std::move(*expected.request);

  gather_costs(expected);
  const volume::RenderRequest& request = *expected.request;
  Volume& volume = *expected.volume;
  try {
    const std::vector<RankWork> work = std::exchange(volume.work, {});  // used once
    const Partition now = renderer_.partition(client, request);
    const Partition next = volume.balancer->decide(
        {now, expected.costs->lattice(), work, *expected.costs, volume.ms_per_block, volume.most_blocks});
    volume.images_since = 0;
    if (settings_.balance == Balance::off) volume.cut_for = appearance(request);
    if (next != now) {
      MoveFigures figures = move({client, request.volume}, volume, request, next);
      figures.deviation = deviation(work);
      settings_.moved(figures);
    }
  } catch (const RankLost&) {
    throw;
  } catch (const std::bad_alloc&) {
    communicator_.abandon(
        "no memory is left to take over blocks of another rank: use more nodes, or --balance off --partition "
        "blocks");
  } catch (const std::exception& error) {
    communicator_.abandon(error.what());
  }
  return std::move(*expected.request);
}

// Returns how many blocks this rank can hold: those that it holds, and those for which it has memory if all
// blocks have their full size (blocks of one value take next to none).
std::size_t Rebalancer::most_blocks_here(const BrickStore& bricks) const {
  // A block that arrives is in a message, unpacked, and in the store for a while.
  constexpr std::size_t copies = 3;
  const std::size_t block_bytes = BrickStore::block_texels * bytes_per_texel(bricks.description().type);
  return bricks.blocks() + settings_.memory_left() / (copies * block_bytes);
}

void Rebalancer::after_image(VolumeKey key, std::span<const RankWork> work) {
  if (const auto volume = volumes_.find(key); volume != volumes_.end())
    volume->second.work.assign(work.begin(), work.end());
}

MoveFigures Rebalancer::move(VolumeKey key, Volume& volume, const volume::RenderRequest& request,
                             const Partition& next) {
  const auto start = Clock::now();
  MoveFigures figures;
  figures.volume = key.volume;
  const BrickStore& bricks = renderer_.bricks(key.client, request);
  const volume::VolumeDescription& description = bricks.description();
  const Partition& now = renderer_.partition(key.client, request);
  for (std::size_t i = 0; i < now.splits.size(); ++i) figures.planes += !(now.splits[i] == next.splits[i]);
  const auto before = volume::boxes(now, description), after = volume::boxes(next, description);
  const std::size_t most_moved = most_blocks_moved(bricks.lattice().box(), before, after);
  std::map<BlockPlace, std::vector<std::byte>> received;
  send_blocks(volume, bricks, before, after, received, figures);
  const auto me = std::size_t(communicator_.rank());
  for (const TexelBox& given :
       difference(blocks_kept(description, before[me]), blocks_kept(description, after[me])))
    for_each_place(given, [&](const BlockPlace& place) { volume.given_away.put(place, bricks.packed(place)); });
  renderer_.divide(key, next, [&](const BlockPlace& place) { return std::move(received.at(place)); });
  volume.most_blocks.clear();  // to be exchanged again
  figures.ms = ms_since(start);
  // The slowest rank's time, so that all ranks use the same.
  std::vector<double> times(std::size_t(communicator_.size()));
  communicator_.gather_to_all(std::as_bytes(std::span(&figures.ms, 1)),
                              std::as_writable_bytes(std::span(times)));
  const double ms = *std::ranges::max_element(times);
  if (most_moved > 0) {
    const double now = ms / double(most_moved);
    volume.ms_per_block = volume.ms_per_block > 0 ? (volume.ms_per_block + now) / 2 : now;
  }
  return figures;
}

/// Blocks to be sent between this rank and each other one.
struct Rebalancer::Traffic {
  explicit Traffic(std::size_t ranks)
      : to(ranks),
        from(ranks),
        wanted(ranks),
        asked(ranks),
        outgoing(ranks),
        incoming(ranks),
        sizes(ranks),
        announced(ranks) {}

  std::vector<std::vector<BlockPlace>> to, from;
  std::vector<std::vector<std::byte>> wanted,
      asked;  ///< a byte for each of `from` and of `to`: 0 if not to be sent
  std::vector<std::vector<std::byte>> outgoing, incoming;  ///< blocks, packed
  std::vector<std::uint64_t> sizes, announced;             ///< of these, in bytes
};

// Every rank tells those that have blocks for it which of them it needs, as its cache may hold some. The
// senders announce the number of bytes, and send them.
void Rebalancer::send_blocks(Volume& volume, const BrickStore& bricks, std::span<const TexelBox> before,
                             std::span<const TexelBox> after,
                             std::map<BlockPlace, std::vector<std::byte>>& received, MoveFigures& figures) {
  const int me = communicator_.rank();
  Traffic traffic{std::size_t(communicator_.size())};
  for (const BlockMove& move : moves(bricks.description(), before, after)) {
    const auto note = [&](std::vector<BlockPlace>& places) {
      for_each_place(move.blocks, [&](const BlockPlace& place) { places.push_back(place); });
    };
    if (move.to == me) note(traffic.from[std::size_t(move.from)]);
    if (move.from == me) note(traffic.to[std::size_t(move.to)]);
  }
  ask_for_blocks(traffic, volume, received, figures);
  announce_blocks(traffic, bricks);
  exchange_blocks(traffic);
  const std::size_t texel = bytes_per_texel(bricks.description().type);
  for (std::size_t rank = 0; rank < traffic.from.size(); ++rank) {
    std::span<const std::byte> bytes(traffic.incoming[rank]);
    figures.bytes_received += bytes.size();
    for (std::size_t i = 0; i < traffic.from[rank].size(); ++i) {
      if (traffic.wanted[rank][i] == std::byte(0)) continue;
      const std::size_t size = texel * (bytes.front() == std::byte(0) ? 1 : BrickStore::block_texels);
      const std::span<const std::byte> packed = bytes.subspan(1, size);
      received[traffic.from[rank][i]].assign(packed.begin(), packed.end());
      bytes = bytes.subspan(1 + size);
      ++figures.blocks_received;
    }
  }
}

void Rebalancer::ask_for_blocks(Traffic& traffic, Volume& volume,
                                std::map<BlockPlace, std::vector<std::byte>>& received, MoveFigures& figures) {
  std::vector<Outgoing> outgoing;
  std::vector<Incoming> incoming;
  for (std::size_t rank = 0; rank < traffic.from.size(); ++rank) {
    for (const BlockPlace& place : traffic.from[rank]) {
      std::optional<std::vector<std::byte>> kept = volume.given_away.take(place);
      traffic.wanted[rank].push_back(std::byte(kept ? 0 : 1));
      if (!kept) continue;
      received[place] = std::move(*kept);
      ++figures.blocks_from_cache;
    }
    traffic.asked[rank].resize(traffic.to[rank].size());
    if (!traffic.wanted[rank].empty()) outgoing.push_back({int(rank), traffic.wanted[rank]});
    if (!traffic.asked[rank].empty()) incoming.push_back({int(rank), traffic.asked[rank]});
  }
  communicator_.transfer(outgoing, incoming);
}

void Rebalancer::announce_blocks(Traffic& traffic, const BrickStore& bricks) {
  const std::size_t texel = bytes_per_texel(bricks.description().type);
  std::vector<Outgoing> outgoing;
  std::vector<Incoming> incoming;
  for (std::size_t rank = 0; rank < traffic.to.size(); ++rank) {
    std::vector<std::byte>& bytes = traffic.outgoing[rank];
    for (std::size_t i = 0; i < traffic.to[rank].size(); ++i) {
      if (traffic.asked[rank][i] == std::byte(0)) continue;
      const std::vector<std::byte> packed = bricks.packed(traffic.to[rank][i]);
      bytes.push_back(std::byte(packed.size() > texel));
      bytes.insert(bytes.end(), packed.begin(), packed.end());
    }
    traffic.sizes[rank] = bytes.size();
    if (!traffic.to[rank].empty()) outgoing.push_back({int(rank), bytes_of(traffic.sizes[rank])});
    if (!traffic.from[rank].empty()) incoming.push_back({int(rank), bytes_of(traffic.announced[rank])});
  }
  communicator_.transfer(outgoing, incoming);
}

void Rebalancer::exchange_blocks(Traffic& traffic) {
  std::vector<Outgoing> outgoing;
  std::vector<Incoming> incoming;
  for (std::size_t rank = 0; rank < traffic.sizes.size(); ++rank) {
    traffic.incoming[rank].resize(traffic.announced[rank]);
    if (traffic.sizes[rank] > 0) outgoing.push_back({int(rank), traffic.outgoing[rank]});
    if (traffic.announced[rank] > 0) incoming.push_back({int(rank), traffic.incoming[rank]});
  }
  communicator_.transfer(outgoing, incoming);
}

void Rebalancer::texels_changed(VolumeKey key, const volume::VolumeDescription& description,
                                std::span<const TexelBox> boxes) {
  const auto found = volumes_.find(key);
  if (found == volumes_.end()) return;
  BlockCache& cache = found->second.given_away;
  // If an axis repeats, a texel is shown at both of its ends.
  if (std::ranges::count(description.wrap, volume::Wrap::repeat) > 0) return cache.clear();
  const TexelBox lattice = volume::cell_lattice(description).box();
  for (const TexelBox& box : boxes) {
    TexelBox blocks;
    for (std::size_t k = 0; k < 3; ++k) {
      // A block holds the texels on both of its faces.
      blocks.low[k] = (box.low[k] - lattice.low[k] - 1) / BrickStore::block_cells;
      blocks.high[k] = (box.high[k] - 1 - lattice.low[k]) / BrickStore::block_cells + 1;
    }
    cache.drop(blocks);
  }
}

void Rebalancer::forget_client(std::uint64_t client) {
  std::erase_if(volumes_, [&](const auto& entry) { return entry.first.client == client; });
}

}  // namespace understudy::compositor
