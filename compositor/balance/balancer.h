// SPDX-License-Identifier: Apache-2.0
// Moves the split planes of a volume's partition so that all ranks draw for equally long. A decision is a pure
// function of its arguments and of the decisions before it: ranks with the same input decide the same, bit for
// bit (the only function of the mathematical library that it calls is the square root).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "volume/block_costs.h"
#include "volume/partition.h"
#include "volume/texel_box.h"

namespace understudy::compositor {

/// What one rank did for an image.
struct RankWork {
  double ms = 0;
  std::uint64_t samples = 0;  ///< samples that it took
};

/// What is known before an image is drawn.
struct BalanceInput {
  const volume::Partition& partition;  ///< the current one
  const volume::TexelBox& lattice;
  /// Of the last image, which this partition drew; empty if there was none.
  std::span<const RankWork> work;
  /// Expected samples of the next image; all must be finite and not negative.
  const volume::BlockCosts& costs;
  double ms_per_block = 0;  ///< to send one block
  /// Blocks that each rank has memory for; empty: no limit. No plane moves to where a rank would hold more.
  std::span<const std::size_t> most_blocks{};
};

class Balancer {
 public:
  virtual ~Balancer() = default;

  /// Returns the partition for the next image. To be called before images of the volume, in their order.
  virtual volume::Partition decide(const BalanceInput& input) = 0;

 protected:
  Balancer() = default;
  Balancer(const Balancer&) = default;
  Balancer(Balancer&&) = default;
  Balancer& operator=(const Balancer&) = default;
  Balancer& operator=(Balancer&&) = default;
};

enum class Balance : std::uint8_t { off, muller, predicted };

/// Sets `balance` from "off", "muller" or "predicted". Returns false, with `balance` unchanged, for others.
bool set_balance(Balance& balance, std::string_view name);

/// After Mueller, Strengert, Ertl 2006. At every split, the root's first, a slice of s blocks goes from the
/// slower to the faster side if the gain exceeds the cost:
///
///     s t + s f c < |t_low - t_high|
///
/// t is the mean time per block, c the time to send one, t_low and t_high the mean times of the ranks on either
/// side. f is a factor for each direction: when a slice has moved, f is raised for the opposite direction and
/// lowered for the same one.
struct MullerSettings {
  double hysteresis = 1;  ///< initial f
  double raised_by = 1;
  double lowered_by = 0.5;
};
std::unique_ptr<Balancer> muller_balancer(const MullerSettings& settings = {});

/// Predicts every rank's time and puts all planes where these times are equal, at once.
///
/// A rank's time is its relative cost, in ms per sample, times the expected samples of its blocks, each times a
/// weight. RelativeCost follows the median of its last three measurements: at once if that is far off, slowly
/// otherwise. Weights correct wrong expectations (of blocks behind opaque ones, say): after each image the
/// weights of a rank's blocks are multiplied so that their sum approaches what the rank really took. They stay
/// with the blocks when these change ranks.
///
/// Planes move if that pays: what staying has cost up to now, plus what it will cost in the next `horizon`
/// images, must exceed the time to send the blocks. Gains within the scatter of measured times do not count.
struct PredictingSettings {
  double horizon = 8;
  double least_gain = 0.03;  ///< as a part of the image's time
};
std::unique_ptr<Balancer> predicting_balancer(const PredictingSettings& settings = {});

/// Cuts the volume anew by cost (by_cost) if that lowers the expected samples of the most expensive rank: for
/// the first image that shows something, and later, unless `then` takes over, at every decision whose gain over
/// the next `horizon` images exceeds the time to send the blocks.
struct CuttingSettings {
  double horizon = 8;
  double least_gain = 0.05;  ///< as a part of the most expensive rank's samples
};
std::unique_ptr<Balancer> cutting_balancer(std::unique_ptr<Balancer> then,
                                           const CuttingSettings& settings = {});

/// Null for `off`, unless the volume is cut by cost.
std::unique_ptr<Balancer> make_balancer(Balance balance,
                                        volume::PartitionMethod method = volume::PartitionMethod::blocks);

}  // namespace understudy::compositor
