// SPDX-License-Identifier: Apache-2.0
// A run of images on several ranks under a balancer, played on one machine: the images are really cast,
// rank by rank, and the samples that each rank takes are counted. A rank's time is its samples times its
// relative cost, and scatters by seeded noise; so a trace is the same on every machine, however loaded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compositor/balance/balancer.h"
#include "volume/partition.h"
#include "volume/request.h"

namespace understudy::bench {

/// What is played: all functions of the image's number alone.
struct TraceScene {
  volume::VolumeDescription description;
  int images = 0;
  int ranks = 4;
  /// The stored texels. They may change with every image; `version` of the request then does, too.
  std::function<std::vector<std::byte>(std::uint64_t version)> texels;
  std::function<volume::RenderRequest(int image)> request;
  std::function<double(int image, int rank)> relative_cost = [](int, int) { return 1; };
  /// From these images on something is different: the first one, always, is 0.
  std::vector<int> events{0};

  double ns_per_sample = 2;
  double gigabytes_per_second = 1;  ///< of a rank's line, either way
  double transfer_latency_ms = 0.05;
  std::size_t cache_bytes = std::size_t(64) << 20;  ///< of blocks that were given away, on each rank
  double noise = 0.05;  ///< times are between so much less and more; one in a hundred is three times as long
  unsigned seed = 1;
};

struct TraceImage {
  double render_ms = 0;    ///< slowest rank, with noise
  double transfer_ms = 0;  ///< before it: busiest rank
  double ideal_ms = 0;     ///< had all samples been divided by the ranks' speeds, without noise
  double deviation = 0;    ///< (max - min) / mean of the ranks' times, without noise
  double imbalance = 0;    ///< slowest rank's time over the ideal one, without noise
  std::size_t bytes = 0;   ///< that travelled
  std::size_t blocks_from_cache = 0;
  int planes_moved = 0;
  int reversals = 0;  ///< of these, planes that moved the other way last time
  std::vector<int> cuts;
};

struct TraceSums {
  double mean_ms = 0;  ///< rendering on the slowest rank, and transfer
  double ideal_ms = 0;
  double mean_deviation = 0;
  double bytes = 0;
  int planes_moved = 0;
  int reversals = 0;
  /// Images after each event until the slowest rank's time stays within a tenth of what it is at the end of
  /// that stretch, the mean over events.
  double settling = 0;
  double end_deviation = 0;  ///< over the last tenth of each stretch between events
};

class TracePlayer {
 public:
  explicit TracePlayer(TraceScene scene);

  /// From a partition by blocks. None: it stays.
  std::vector<TraceImage> play(compositor::Balancer* balancer);
  TraceSums sums(const std::vector<TraceImage>& trace) const;
  const TraceScene& scene() const { return scene_; }

 private:
  struct Version {
    std::uint64_t number = 0;
    std::vector<std::byte> texels;
    std::vector<std::size_t> packed;  ///< bytes of every block as it travels, x fastest
  };

  struct Group;

  void count_planes(const volume::Partition& next, Group& group, TraceImage& now);
  void move_blocks(const Version& texels, const volume::Partition& next, Group& group, TraceImage& now);
  void render(int image, Group& group, TraceImage& now);
  const Version& version(std::uint64_t number);
  const volume::BlockCosts& expected(int image);
  std::uint64_t samples(int image, const volume::TexelBox& box);
  double measured_ms(int image, int rank, std::uint64_t samples) const;

  TraceScene scene_;
  volume::TexelBox lattice_;
  std::map<std::uint64_t, Version> versions_;
  std::map<int, volume::BlockCosts> expected_;
  std::map<std::pair<int, std::vector<int>>, std::uint64_t> samples_;
  class Stores;
  std::shared_ptr<Stores> stores_;
};

}  // namespace understudy::bench
