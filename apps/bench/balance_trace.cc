// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/balance_trace.h"

#include <algorithm>
#include <cmath>
#include <list>
#include <random>
#include <utility>

#include "compositor/balance/block_cache.h"
#include "compositor/balance/moves.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/expected_samples.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::bench {

using compositor::BlockCache;
using compositor::BlockMove;
using compositor::BlockPlace;
using compositor::RankWork;
using volume::BrickStore;
using volume::Partition;
using volume::TexelBox;

namespace {

BrickStore filled(const volume::VolumeDescription& description, const TexelBox& box,
                  const std::vector<std::byte>& texels) {
  BrickStore store(description, box);
  store.add_slices(description.stored, texels);
  store.finish();
  return store;
}

template <class Visit>
void for_each_block(const TexelBox& blocks, const Visit& visit) {
  for (int z = blocks.low[2]; z < blocks.high[2]; ++z)
    for (int y = blocks.low[1]; y < blocks.high[1]; ++y)
      for (int x = blocks.low[0]; x < blocks.high[0]; ++x) visit(BlockPlace{x, y, z});
}

int direction(int from, int to) {
  return to > from ? 1 : to < from ? -1 : 0;
}

}  // namespace

/// The bricks of the boxes that were drawn most recently, each with its ray caster.
class TracePlayer::Stores {
 public:
  struct Entry {
    std::uint64_t version = 0;
    TexelBox box;
    BrickStore store;
    volume::RayCaster caster;
    Entry(std::uint64_t number, const TexelBox& of, BrickStore filled)
        : version(number), box(of), store(std::move(filled)), caster(store) {}
  };

  template <class Make>
  Entry& find(std::uint64_t version, const TexelBox& box, const Make& make) {
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
      if (entry->version == version && entry->box == box) {
        entries_.splice(entries_.begin(), entries_, entry);
        return entries_.front();
      }
    constexpr std::size_t most = 24;
    if (entries_.size() >= most) entries_.pop_back();
    return entries_.emplace_front(version, box, make());
  }

 private:
  std::list<Entry> entries_;
};

TracePlayer::TracePlayer(TraceScene scene)
    : scene_(std::move(scene)),
      lattice_(volume::cell_lattice(scene_.description).box()),
      stores_(std::make_shared<Stores>()) {}

const TracePlayer::Version& TracePlayer::version(std::uint64_t number) {
  const auto found = versions_.find(number);
  if (found != versions_.end()) return found->second;
  Version made{number, scene_.texels(number), {}};
  const BrickStore whole = filled(scene_.description, lattice_, made.texels);
  const std::size_t texel = bytes_per_texel(scene_.description.type);
  for (std::size_t b = 0; b < whole.blocks(); ++b) {
    const auto ranges = whole.ranges(b);
    const bool constant =
        std::ranges::all_of(ranges, [](const auto& range) { return range.low == range.high; });
    made.packed.push_back(1 + texel * (constant ? 1 : BrickStore::block_texels));
  }
  return versions_.emplace(number, std::move(made)).first->second;
}

const volume::BlockCosts& TracePlayer::expected(int frame) {
  const auto found = expected_.find(frame);
  if (found != expected_.end()) return found->second;
  const volume::RenderRequest request = scene_.request(frame);
  const Version& texels = version(request.version);
  Stores::Entry& whole = stores_->find(request.version, lattice_,
                                       [&] { return filled(scene_.description, lattice_, texels.texels); });
  volume::BlockCosts costs(lattice_, BrickStore::block_cells);
  volume::add_expected_samples(whole.store, request, costs);
  return expected_.emplace(frame, std::move(costs)).first->second;
}

std::uint64_t TracePlayer::samples(int frame, const TexelBox& box) {
  if (volume::is_empty(box)) return 0;
  std::vector<int> key(box.low.begin(), box.low.end());
  key.insert(key.end(), box.high.begin(), box.high.end());
  const auto found = samples_.find({frame, key});
  if (found != samples_.end()) return found->second;
  const volume::RenderRequest request = scene_.request(frame);
  const Version& texels = version(request.version);
  Stores::Entry& entry =
      stores_->find(request.version, box, [&] { return filled(scene_.description, box, texels.texels); });
  volume::Image image(volume::footprint(request, scene_.description, box));
  volume::FrameCounts counts;
  entry.caster.render(request, image, counts);
  samples_[{frame, key}] = counts.samples_taken;
  return counts.samples_taken;
}

double TracePlayer::measured_ms(int frame, int rank, std::uint64_t samples) const {
  std::seed_seq seed{scene_.seed, unsigned(frame), unsigned(rank)};
  std::mt19937 random(seed);
  const double unit = double(random()) / double(std::mt19937::max());
  const bool interrupted = random() % 100 == 0;
  const double ms = 1e-6 * scene_.ns_per_sample * double(samples) * scene_.relative_cost(frame, rank);
  return ms * (1 + scene_.noise * (2 * unit - 1)) * (interrupted && scene_.noise > 0 ? 3 : 1);
}

/// The state of the ranks that is carried from image to image.
struct TracePlayer::Group {
  Partition partition;
  std::vector<RankWork> work;
  std::vector<BlockCache> caches;
  std::vector<int> last_direction;  ///< last direction in which each split plane moved
  double ms_per_block = 0;
};

void TracePlayer::count_planes(const Partition& next, Group& group, TraceImage& now) {
  for (std::size_t i = 0; i < next.splits.size(); ++i) {
    const int way = direction(group.partition.splits[i].cut, next.splits[i].cut);
    if (way == 0) continue;
    ++now.planes_moved;
    now.reversals += way == -group.last_direction[i];
    group.last_direction[i] = way;
  }
}

void TracePlayer::move_blocks(const Version& texels, const Partition& next, Group& group, TraceImage& now) {
  const auto ranks = std::size_t(scene_.ranks);
  const TexelBox blocks = compositor::blocks_owned(lattice_, lattice_);
  const auto packed_bytes = [&](const BlockPlace& place) {
    const std::size_t row = std::size_t(place[2]) * std::size_t(blocks.high[1]) + std::size_t(place[1]);
    return texels.packed[row * std::size_t(blocks.high[0]) + std::size_t(place[0])];
  };
  const auto before = volume::boxes(group.partition, scene_.description),
             after = volume::boxes(next, scene_.description);
  std::vector<std::size_t> sent(ranks), received(ranks);
  for (const BlockMove& move : compositor::moves(scene_.description, before, after))
    for_each_block(move.blocks, [&](const BlockPlace& place) {
      const std::size_t bytes = packed_bytes(place);
      if (group.caches[std::size_t(move.to)].take(place)) {
        ++now.blocks_from_cache;
        return;
      }
      now.bytes += bytes;
      sent[std::size_t(move.from)] += bytes;
      received[std::size_t(move.to)] += bytes;
    });
  for (std::size_t rank = 0; rank < ranks; ++rank)
    for (const TexelBox& given :
         compositor::difference(compositor::blocks_kept(scene_.description, before[rank]),
                                compositor::blocks_kept(scene_.description, after[rank])))
      for_each_block(given, [&](const BlockPlace& place) {
        group.caches[rank].put(place, std::vector<std::byte>(packed_bytes(place)));
      });
  const double busiest = double(std::max(*std::ranges::max_element(sent), *std::ranges::max_element(received)));
  now.transfer_ms = scene_.transfer_latency_ms + busiest / (1e6 * scene_.gigabytes_per_second);
  const std::size_t moved = compositor::most_blocks_moved(lattice_, before, after);
  if (moved > 0) group.ms_per_block = (group.ms_per_block + now.transfer_ms / double(moved)) / 2;
  group.partition = next;
}

void TracePlayer::render(int frame, Group& group, TraceImage& now) {
  const auto parts = volume::boxes(group.partition, scene_.description);
  group.work.clear();
  double slowest = 0, fastest = 0, sum = 0, all_samples = 0, all_speed = 0;
  for (int rank = 0; rank < scene_.ranks; ++rank) {
    const std::uint64_t taken = samples(frame, parts[std::size_t(rank)]);
    const double relative_cost = scene_.relative_cost(frame, rank);
    const double ms = 1e-6 * scene_.ns_per_sample * double(taken) * relative_cost;
    slowest = std::max(slowest, ms);
    fastest = rank == 0 ? ms : std::min(fastest, ms);
    sum += ms;
    all_samples += double(taken);
    all_speed += 1 / relative_cost;
    group.work.push_back({measured_ms(frame, rank, taken), taken});
    now.render_ms = std::max(now.render_ms, group.work.back().ms);
  }
  now.ideal_ms = 1e-6 * scene_.ns_per_sample * all_samples / all_speed;
  now.deviation = sum > 0 ? (slowest - fastest) * double(scene_.ranks) / sum : 0;
  now.imbalance = now.ideal_ms > 0 ? slowest / now.ideal_ms : 1;
  for (const Partition::Split& split : group.partition.splits) now.cuts.push_back(split.cut);
}

std::vector<TraceImage> TracePlayer::play(compositor::Balancer* balancer) {
  Group group;
  group.partition = volume::by_blocks(scene_.description, scene_.ranks);
  group.caches.assign(std::size_t(scene_.ranks), BlockCache(scene_.cache_bytes));
  group.last_direction.resize(group.partition.splits.size());
  group.ms_per_block = double(bytes_per_texel(scene_.description.type) * BrickStore::block_texels) /
                       (1e6 * scene_.gigabytes_per_second);
  std::vector<TraceImage> trace;
  std::uint64_t drawn_version = scene_.request(0).version;
  for (int frame = 0; frame < scene_.images; ++frame) {
    TraceImage& now = trace.emplace_back();
    const Version& texels = version(scene_.request(frame).version);
    if (texels.number != drawn_version)
      for (BlockCache& cache : group.caches) cache.clear();
    drawn_version = texels.number;
    if (balancer != nullptr) {
      const Partition next =
          balancer->decide({group.partition, lattice_, group.work, expected(frame), group.ms_per_block});
      count_planes(next, group, now);
      if (now.planes_moved > 0) move_blocks(texels, next, group, now);
    }
    render(frame, group, now);
  }
  return trace;
}

TraceSums TracePlayer::sums(const std::vector<TraceImage>& trace) const {
  TraceSums sums;
  const auto images = double(trace.size());
  for (const TraceImage& frame : trace) {
    sums.mean_ms += (frame.render_ms + frame.transfer_ms) / images;
    sums.ideal_ms += frame.ideal_ms / images;
    sums.mean_deviation += frame.deviation / images;
    sums.bytes += double(frame.bytes);
    sums.planes_moved += frame.planes_moved;
    sums.reversals += frame.reversals;
  }
  for (std::size_t e = 0; e < scene_.events.size(); ++e) {
    const auto begin = std::size_t(scene_.events[e]);
    const auto end = e + 1 < scene_.events.size() ? std::size_t(scene_.events[e + 1]) : trace.size();
    const std::size_t tail = std::max<std::size_t>(1, (end - begin) / 10);
    double level = 0;
    for (std::size_t i = end - tail; i < end; ++i) {
      level += trace[i].imbalance / double(tail);
      sums.end_deviation += trace[i].deviation / double(tail) / double(scene_.events.size());
    }
    std::size_t settled = end;
    while (settled > begin && trace[settled - 1].imbalance <= 1.1 * level) --settled;
    sums.settling += double(settled - begin) / double(scene_.events.size());
  }
  return sums;
}

}  // namespace understudy::bench
