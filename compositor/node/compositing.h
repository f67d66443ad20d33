// SPDX-License-Identifier: Apache-2.0
// Combines the images of all ranks into one image in the image buffer: which exchange is chosen, what is sent,
// and what would be sent without footprints.
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

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::compositor {

/// One image; the same on all ranks.
struct ImageTask {
  std::uint64_t client = 0;
  volume::Operator op{};
  volume::Rect window;          ///< that all samples lie in
  Layout layout{};              ///< in which its parts are sent
  bool only_footprints = true;  ///< no whole windows are sent
  std::vector<Rank> order;      ///< all ranks, front first
  bool divided = false;         ///< each rank draws a leaf of its own: nothing is blended
};

class Compositing {
 public:
  Compositing(Communicator& communicator, const ExchangeSettings& settings)
      : communicator_(communicator), settings_(settings) {}

  /// Returns the layout of an image: that of the settings, but floats if it must be exact; half floats instead
  /// of floats if the request allows them. Bounds of errors are always floats.
  Layout layout(const volume::RenderRequest& request) const;

  /// Collective, before anything else: measures message costs, once.
  void prepare();

  /// Collective: composites what the ranks have drawn, `mine` here and `footprints` by rank, in the image
  /// buffer. Returns the rectangle that the buffer then holds: `whole` if given, which contains all footprints,
  /// otherwise the smallest that does. Null, on all ranks, if the buffer is too small. On rank 0, adds what was
  /// sent to `counts`.
  std::optional<volume::Rect> composite(const ImageTask& task, volume::Image mine,
                                        std::span<const volume::Rect> footprints,
                                        const ImageBuffers::Memory& memory, volume::FrameCounts& counts,
                                        const std::optional<volume::Rect>& whole = std::nullopt);

  /// Adds to `counts` what the image would cost if every rank sent the whole window.
  void add_cost_of_whole_windows(const ImageTask& task, const ImageBuffers::Memory& memory,
                                 volume::FrameCounts& counts);

 private:
  Schedule schedule_of(const ImageTask& task, std::span<const volume::Rect> footprints,
                       const std::vector<bool>& reached_by) const;

  Communicator& communicator_;
  ExchangeSettings settings_;
  std::optional<MessageCost> message_cost_;
  // The cost of images without footprints, for this window, layout and reached_by.
  volume::Rect priced_window_;
  Layout priced_layout_{};
  std::vector<bool> priced_reached_by_;
  ExchangeCost price_;
};

}  // namespace understudy::compositor
