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
#include "volume/cell_lattice.h"
#include "volume/raycast/expected_samples.h"

namespace understudy::compositor {

using volume::BlockCosts;
using volume::BrickStore;
using volume::Partition;
using volume::TexelBox;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_cubes = std::size_t(1) << 15;  // 128 KiB of costs travel before an image

/// The finest costs of which there are not too many.
int cost_edge(const TexelBox& lattice) {
  for (int edge = BrickStore::block_cells;; edge *= 2) {
    std::size_t cubes = 1;
    for (std::size_t k = 0; k < 3; ++k)
      cubes *= std::size_t((lattice.high[k] - lattice.low[k] + edge - 1) / edge);
    if (cubes <= most_cubes) return edge;
  }
}

/// The cubes in which blocks of these cells lie.
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

double deviation(std::span<const RankWork> work) {
  if (work.empty()) return 0;
  double least = work[0].ms, most = work[0].ms, sum = 0;
  for (const RankWork& rank : work) {
    least = std::min(least, rank.ms);
    most = std::max(most, rank.ms);
    sum += rank.ms;
  }
  return sum > 0 ? (most - least) * double(work.size()) / sum : 0;
}

}  // namespace

Rebalancer::Rebalancer(Communicator& communicator, RankRenderer& renderer, BalanceSettings settings)
    : communicator_(communicator), renderer_(renderer), settings_(std::move(settings)) {}

bool Rebalancer::all_agree(bool mine) {
  const auto vote = std::uint8_t(mine);
  std::vector<std::uint8_t> votes(std::size_t(communicator_.size()));
  communicator_.gather_to_all(std::as_bytes(std::span(&vote, 1)), std::as_writable_bytes(std::span(votes)));
  return std::ranges::count(votes, 0) == 0;
}

volume::RenderRequest Rebalancer::before_image(std::uint64_t client,
                                               const std::function<volume::RenderRequest()>& decode) {
  // Nothing that may fail on one rank alone stands between two calls in which all take part.
  std::optional<volume::RenderRequest> request;
  std::optional<BlockCosts> costs;
  std::vector<float> mine, all;
  std::vector<TexelBox> boxes;
  std::size_t most_here = 0;
  std::vector<std::size_t> most_blocks;
  Volume* volume = nullptr;
  std::exception_ptr trouble;
  try {
    request = decode();
    const BrickStore& bricks = renderer_.bricks(client, *request);
    const TexelBox lattice = bricks.lattice().box();
    boxes = volume::boxes(renderer_.partition(client, *request), bricks.description());
    const VolumeKey key{client, request->volume};
    auto known = volumes_.find(key);
    if (known == volumes_.end())
      known =
          volumes_
              .emplace(key,
                       Volume{make_balancer(settings_.balance), BlockCache(settings_.cache_bytes), {}, 0, {}})
              .first;
    volume = &known->second;
    costs.emplace(lattice, cost_edge(lattice));
    volume::add_expected_samples(bricks, *request, *costs);
    std::size_t most = 0;
    for (const TexelBox& box : boxes) most = std::max(most, volume::texels_in(cubes_touched(*costs, box)));
    if (volume->most_blocks.empty()) {
      most_here = most_blocks_here(bricks);
      most_blocks.resize(boxes.size());
    }
    mine.resize(most);
    all.resize(most * boxes.size());
    std::size_t next = 0;
    for_each_place(cubes_touched(*costs, boxes[std::size_t(communicator_.rank())]),
                   [&](const BlockPlace& cube) { mine[next++] = float(costs->values()[costs->index(cube)]); });
  } catch (...) {
    trouble = std::current_exception();
  }
  const bool agreed = all_agree(trouble == nullptr);
  if (trouble) std::rethrow_exception(trouble);
  if (!agreed) return std::move(*request);  // another rank refuses it

  if (volume->most_blocks.empty()) {
    communicator_.gather_to_all(bytes_of(most_here), std::as_writable_bytes(std::span(most_blocks)));
    volume->most_blocks = std::move(most_blocks);
  }
  communicator_.gather_to_all(std::as_bytes(std::span(mine)), std::as_writable_bytes(std::span(all)));
  std::ranges::fill(costs->values(), 0.0);
  for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
    const float* value = all.data() + rank * mine.size();
    for_each_place(cubes_touched(*costs, boxes[rank]),
                   [&](const BlockPlace& cube) { costs->values()[costs->index(cube)] += double(*value++); });
  }
  try {
    const Partition now = renderer_.partition(client, *request);
    const Partition next = volume->balancer->decide(
        {now, costs->lattice(), volume->work, *costs, volume->ms_per_block, volume->most_blocks});
    volume->work.clear();  // learned from
    if (next != now) move({client, request->volume}, *volume, *request, next);
  } catch (const RankLost&) {
    throw;
  } catch (const std::bad_alloc&) {
    communicator_.abandon(
        "no memory is left to take over blocks of another rank: use more nodes, or --balance off");
  } catch (const std::exception& error) {
    communicator_.abandon(error.what());
  }
  return std::move(*request);
}

// What this rank holds, and what more it has memory for if all blocks take as much as they can: those of one
// value take next to none.
std::size_t Rebalancer::most_blocks_here(const BrickStore& bricks) const {
  // A block that comes is in a message, unpacked, and in the store for a while.
  constexpr std::size_t copies = 3;
  const std::size_t block_bytes = BrickStore::block_texels * bytes_per_texel(bricks.description().type);
  return bricks.blocks() + settings_.memory_left() / (copies * block_bytes);
}

void Rebalancer::after_image(VolumeKey key, std::span<const RankWork> work) {
  if (const auto volume = volumes_.find(key); volume != volumes_.end())
    volume->second.work.assign(work.begin(), work.end());
}

void Rebalancer::move(VolumeKey key, Volume& volume, const volume::RenderRequest& request,
                      const Partition& next) {
  const auto start = Clock::now();
  MoveFigures figures;
  figures.volume = key.volume;
  figures.deviation = deviation(volume.work);
  const BrickStore& bricks = renderer_.bricks(key.client, request);
  const volume::VolumeDescription& description = bricks.description();
  const Partition& now = renderer_.partition(key.client, request);
  for (std::size_t i = 0; i < now.splits.size(); ++i) figures.planes += now.splits[i].cut != next.splits[i].cut;
  const auto before = volume::boxes(now, description), after = volume::boxes(next, description);
  const std::size_t most_moved = most_blocks_moved(bricks.lattice().box(), before, after);
  std::map<BlockPlace, std::vector<std::byte>> received;
  send_blocks(volume, bricks, before, after, received, figures);
  const auto me = std::size_t(communicator_.rank());
  for (const TexelBox& given :
       difference(blocks_kept(description, before[me]), blocks_kept(description, after[me])))
    for_each_place(given, [&](const BlockPlace& place) { volume.given_away.put(place, bricks.packed(place)); });
  renderer_.divide(key, next, [&](const BlockPlace& place) { return std::move(received.at(place)); });
  volume.most_blocks.clear();  // asked for anew
  figures.ms = ms_since(start);
  // The slowest rank's, so that all reckon with the same.
  std::vector<double> times(std::size_t(communicator_.size()));
  communicator_.gather_to_all(std::as_bytes(std::span(&figures.ms, 1)),
                              std::as_writable_bytes(std::span(times)));
  const double ms = *std::ranges::max_element(times);
  if (most_moved > 0) {
    const double now = ms / double(most_moved);
    volume.ms_per_block = volume.ms_per_block > 0 ? (volume.ms_per_block + now) / 2 : now;
  }
  settings_.moved(figures);
}

// Every rank tells those that have blocks for it which of them it does not keep from earlier; these say how
// many bytes they are, and send them.
void Rebalancer::send_blocks(Volume& volume, const BrickStore& bricks, std::span<const TexelBox> before,
                             std::span<const TexelBox> after,
                             std::map<BlockPlace, std::vector<std::byte>>& received, MoveFigures& figures) {
  const auto ranks = std::size_t(communicator_.size());
  const int me = communicator_.rank();
  std::vector<std::vector<BlockPlace>> to(ranks), from(ranks);
  for (const BlockMove& move : moves(bricks.description(), before, after)) {
    if (move.to == me)
      for_each_place(move.blocks,
                     [&](const BlockPlace& place) { from[std::size_t(move.from)].push_back(place); });
    if (move.from == me)
      for_each_place(move.blocks, [&](const BlockPlace& place) { to[std::size_t(move.to)].push_back(place); });
  }
  std::vector<std::vector<std::byte>> wanted(ranks), asked(ranks), outgoing_bytes(ranks), incoming_bytes(ranks);
  std::vector<std::uint64_t> sizes(ranks), announced(ranks);
  std::vector<Outgoing> outgoing;
  std::vector<Incoming> incoming;
  const auto transfer = [&] {
    communicator_.transfer(outgoing, incoming);
    outgoing.clear();
    incoming.clear();
  };

  for (std::size_t rank = 0; rank < ranks; ++rank) {
    for (const BlockPlace& place : from[rank]) {
      std::optional<std::vector<std::byte>> kept = volume.given_away.take(place);
      wanted[rank].push_back(std::byte(kept ? 0 : 1));
      if (!kept) continue;
      received[place] = std::move(*kept);
      ++figures.blocks_from_cache;
    }
    asked[rank].resize(to[rank].size());
    if (!wanted[rank].empty()) outgoing.push_back({int(rank), wanted[rank]});
    if (!asked[rank].empty()) incoming.push_back({int(rank), asked[rank]});
  }
  transfer();

  const std::size_t texel = bytes_per_texel(bricks.description().type);
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    std::vector<std::byte>& bytes = outgoing_bytes[rank];
    for (std::size_t i = 0; i < to[rank].size(); ++i) {
      if (asked[rank][i] == std::byte(0)) continue;
      const std::vector<std::byte> packed = bricks.packed(to[rank][i]);
      bytes.push_back(std::byte(packed.size() > texel));
      bytes.insert(bytes.end(), packed.begin(), packed.end());
    }
    sizes[rank] = bytes.size();
    if (!to[rank].empty()) outgoing.push_back({int(rank), bytes_of(sizes[rank])});
    if (!from[rank].empty()) incoming.push_back({int(rank), bytes_of(announced[rank])});
  }
  transfer();

  for (std::size_t rank = 0; rank < ranks; ++rank) {
    incoming_bytes[rank].resize(announced[rank]);
    if (sizes[rank] > 0) outgoing.push_back({int(rank), outgoing_bytes[rank]});
    if (announced[rank] > 0) incoming.push_back({int(rank), incoming_bytes[rank]});
  }
  transfer();

  for (std::size_t rank = 0; rank < ranks; ++rank) {
    std::span<const std::byte> bytes(incoming_bytes[rank]);
    figures.bytes_received += bytes.size();
    for (std::size_t i = 0; i < from[rank].size(); ++i) {
      if (wanted[rank][i] == std::byte(0)) continue;
      const std::size_t size = texel * (bytes.front() == std::byte(0) ? 1 : BrickStore::block_texels);
      const std::span<const std::byte> packed = bytes.subspan(1, size);
      received[from[rank][i]].assign(packed.begin(), packed.end());
      bytes = bytes.subspan(1 + size);
      ++figures.blocks_received;
    }
  }
}

void Rebalancer::texels_changed(VolumeKey key, const volume::VolumeDescription& description,
                                std::span<const TexelBox> boxes) {
  const auto found = volumes_.find(key);
  if (found == volumes_.end()) return;
  BlockCache& cache = found->second.given_away;
  // Where an axis repeats, a texel shows at both of its ends.
  if (std::ranges::count(description.wrap, volume::Wrap::repeat) > 0) return cache.clear();
  const TexelBox lattice = volume::cell_lattice(description).box();
  for (const TexelBox& box : boxes) {
    TexelBox blocks;
    for (std::size_t k = 0; k < 3; ++k) {
      // A block shows the texels on both of its faces.
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
