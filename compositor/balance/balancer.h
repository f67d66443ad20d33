// SPDX-License-Identifier: Apache-2.0
// Moves the split planes of a volume's partition, such that all ranks draw equally long. A decision is a pure
// function of what is handed in and of the decisions before: ranks that are told the same decide the same, bit
// for bit (there is no call of the mathematical library in it but square roots).
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
  std::uint64_t samples = 0;  ///< that it took
};

/// What there is to know before an image is drawn.
struct BalanceInput {
  const volume::Partition& partition;  ///< as it is
  const volume::TexelBox& lattice;
  /// Of the last image, which this partition drew; empty: there was none.
  std::span<const RankWork> work;
  /// Samples to be expected in the image to come; all must be finite and not negative.
  const volume::BlockCosts& costs;
  double ms_per_block = 0;  ///< that travels
  /// Blocks that each rank has memory for; empty: all of them. No plane goes where a rank would hold more.
  std::span<const std::size_t> most_blocks{};
};

class Balancer {
 public:
  virtual ~Balancer() = default;

  /// The partition for the image to come. To be called before images of the volume, in their order.
  virtual volume::Partition decide(const BalanceInput& input) = 0;

 protected:
  Balancer() = default;
  Balancer(const Balancer&) = default;
  Balancer(Balancer&&) = default;
  Balancer& operator=(const Balancer&) = default;
  Balancer& operator=(Balancer&&) = default;
};

enum class Balance : std::uint8_t { off, muller, predicted };

/// "off", "muller" or "predicted". False, with `balance` unchanged, for any other.
bool set_balance(Balance& balance, std::string_view name);

/// After Mueller, Strengert, Ertl 2006. At every split, the root's first, a slice of s blocks goes from the
/// slower to the faster side when that is worth more than what it costs:
///
///     s t + s f c < |t_low - t_high|
///
/// t is the mean time per block, c the time to send one, t_low and t_high the mean times of either side's
/// ranks. f is one number per direction: raised for the way back whenever a slice has moved, lowered for more
/// of the same.
struct MullerSettings {
  double hysteresis = 1;  ///< f to begin with
  double raised_by = 1;
  double lowered_by = 0.5;
};
std::unique_ptr<Balancer> muller_balancer(const MullerSettings& settings = {});

/// Predicts every rank's time and puts all planes where these are equal, at once.
///
/// A rank's time is its relative cost, in ms per sample, times the expected samples of its blocks, each times a
/// weight. RelativeCost follows the median of its last three measurements, at once when that is far off and
/// slowly otherwise. Weights say how far expectation was off where (opaque things in front, say): those of a
/// rank's blocks are multiplied until their sum is what the rank really took, and stay with the blocks when the
/// rank does not.
///
/// Planes move when that pays: what staying has cost up to now, and will in the next `horizon` images, must
/// be more than what the blocks take to travel. Gains that are within what measured times scatter do not count.
struct PredictingSettings {
  double horizon = 8;
  double least_gain = 0.03;  ///< as a part of the image's time
};
std::unique_ptr<Balancer> predicting_balancer(const PredictingSettings& settings = {});

/// Cuts the volume anew where that makes the dearest rank's samples, as they are expected, fewer (by_cost): for
/// the first image, and then, where it is not `then` that goes on, whenever it is asked and the gain in the
/// next `horizon` images is more than what the blocks take to travel.
struct CuttingSettings {
  double horizon = 8;
  double least_gain = 0.05;  ///< as a part of the dearest rank's samples
};
std::unique_ptr<Balancer> cutting_balancer(std::unique_ptr<Balancer> then,
                                           const CuttingSettings& settings = {});

/// None for `off`, where the volume is not cut by cost.
std::unique_ptr<Balancer> make_balancer(Balance balance,
                                        volume::PartitionMethod method = volume::PartitionMethod::blocks);

}  // namespace understudy::compositor
