// SPDX-License-Identifier: Apache-2.0
// Simulates a sequence of images on several load-balanced ranks on one machine. The images are really cast,
// rank by rank, and the samples of each rank are counted. A rank's time is its number of samples times its
// relative cost, plus seeded noise; so a trace is the same on every machine, whatever its load.
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

/// The simulated scene; each function depends on its arguments alone.
struct TraceScene {
  volume::VolumeDescription description;
  int images = 0;
  int ranks = 4;
  /// The stored texels of a version. If they change with an image, so does `version` in that image's request.
  std::function<std::vector<std::byte>(std::uint64_t version)> texels;
  std::function<volume::RenderRequest(int image)> request;
  std::function<double(int image, int rank)> relative_cost = [](int, int) { return 1; };
  /// Numbers of the images at which the scene changes; the first one is always 0.
  std::vector<int> events{0};

  double ns_per_sample = 2;
  double gigabytes_per_second = 1;  ///< bandwidth of a rank's network connection, in each direction
  double transfer_latency_ms = 0.05;
  std::size_t cache_bytes = std::size_t(64) << 20;  ///< for the blocks that a rank has sent away, on each rank
  double noise = 0.05;  ///< relative amplitude; in addition, one time in a hundred is tripled
  unsigned seed = 1;
};

struct TraceImage {
  double render_ms = 0;    ///< time of the slowest rank, with noise
  double transfer_ms = 0;  ///< transfer of blocks before rendering, on the busiest rank
  double ideal_ms = 0;     ///< if all samples were divided in proportion to the ranks' speeds, without noise
  double deviation = 0;    ///< (max - min) / mean of the ranks' times, without noise
  double imbalance = 0;    ///< the slowest rank's time divided by the ideal one, without noise
  std::size_t bytes = 0;   ///< sent between ranks
  std::size_t blocks_from_cache = 0;
  int planes_moved = 0;
  int reversals = 0;  ///< planes that moved in the opposite direction to their last move
  std::vector<int> cuts;
};

struct TraceSums {
  double mean_ms = 0;  ///< rendering on the slowest rank, plus transfer
  double ideal_ms = 0;
  double mean_deviation = 0;
  double bytes = 0;
  int planes_moved = 0;
  int reversals = 0;
  /// Number of images after an event until the slowest rank's imbalance stays within 10 % of its level at the
  /// end of the interval between events; the mean over all events.
  double settling = 0;
  double end_deviation = 0;  ///< mean over the last tenth of each interval between events
};

class TracePlayer {
 public:
  explicit TracePlayer(TraceScene scene);

  /// Plays all images, starting from a partition by blocks. A null balancer keeps that partition.
  std::vector<TraceImage> play(compositor::Balancer* balancer);
  TraceSums sums(const std::vector<TraceImage>& trace) const;
  const TraceScene& scene() const { return scene_; }

 private:
  struct Version {
    std::uint64_t number = 0;
    std::vector<std::byte> texels;
    std::vector<std::size_t> packed;  ///< size of each block when sent, in bytes; x fastest
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
