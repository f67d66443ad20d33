// SPDX-License-Identifier: Apache-2.0
// How the images of all ranks become one image in the application's memory: which exchange is chosen for it,
// what travels, and what would have without footprints.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/cost.h"
#include "compositor/exchange/schedule.h"
#include "compositor/exchange/settings.h"
#include "compositor/node/image_buffer.h"
#include "volume/blending_operator.h"
#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Of one image: the same on all ranks.
struct ImageTask {
  std::uint64_t client = 0;
  volume::Operator op{};
  volume::Rect window;          ///< that all samples lie in
  Layout layout{};              ///< that its parts travel in
  bool only_footprints = true;  ///< travel
  std::vector<Rank> order;      ///< all ranks, front first
  bool divided = false;         ///< each rank draws a leaf of its own: there is nothing to blend
};

class Compositing {
 public:
  Compositing(Communicator& communicator, const ExchangeSettings& settings)
      : communicator_(communicator), settings_(settings) {}

  /// The layout of an image whose request may do with half floats.
  Layout layout(bool may_travel_as_halves) const;

  /// Collective, before anything else: measures the communicator, once.
  void prepare();

  /// Collective: what the ranks have drawn, `mine` here and `footprints` by rank, goes to the memory. Returns
  /// the rectangle that the memory then holds: `whole` where one is given, with all footprints in it, or the
  /// smallest that holds these. Nothing, on all ranks, where the memory has no room for it. Adds to `counts`,
  /// on rank 0, what travelled.
  std::optional<volume::Rect> composite(const ImageTask& task, volume::Image mine,
                                        std::span<const volume::Rect> footprints,
                                        const ImageBuffers::Memory& memory, volume::FrameCounts& counts,
                                        const std::optional<volume::Rect>& whole = std::nullopt);

  /// Adds to `counts` what the image would cost if every rank sent the window whole.
  void add_cost_of_whole_windows(const ImageTask& task, const ImageBuffers::Memory& memory,
                                 volume::FrameCounts& counts);

 private:
  Schedule schedule_of(const ImageTask& task, std::span<const volume::Rect> footprints,
                       const std::vector<bool>& reached_by) const;

  Communicator& communicator_;
  ExchangeSettings settings_;
  std::optional<MessageCost> message_cost_;
  // What images of such a window cost without footprints.
  volume::Rect priced_window_;
  Layout priced_layout_{};
  std::vector<bool> priced_reached_by_;
  ExchangeCost price_;
};

}  // namespace understudy::compositor
