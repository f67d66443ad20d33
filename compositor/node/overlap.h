// SPDX-License-Identifier: Apache-2.0
// Compositing while drawing: an image is drawn in bands of rows, and each band is composited while the next
// one is drawn, so that a slow network costs little more than its last band. Nearer ranks do not tell farther
// ones of opaque tiles meanwhile: all draw the same band at the same time, and control messages would come too
// late.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "compositor/node/compositing.h"
#include "compositor/node/image_buffer.h"
#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::compositor {

/// `rect` from the bottom up, in at most 8 bands of 64 Ki pixels or more, which begin at multiples of 16 rows
/// from its lowest.
std::vector<volume::Rect> bands_of(const volume::Rect& rect);

/// Draws and composites an image band by band; collective. `draw` gives this rank's image of a band, or
/// nothing where it cannot go on: then all ranks give up after the same band. `whole` is the rectangle that the
/// memory holds afterwards, the same on all ranks; all that is drawn lies in it. Returns whether the image is
/// there; adds to `travelled` as Compositing::composite() does. The communicator is used by other threads than
/// the caller's meanwhile, one at a time. Throws what an exchange throws: then this rank is out of step with
/// the others, and must not go on.
bool draw_and_composite(Communicator& communicator, Compositing& compositing, const ImageTask& task,
                        const ImageBuffers::Memory& memory, const volume::Rect& whole,
                        const std::function<std::optional<volume::Image>(const volume::Rect& band)>& draw,
                        volume::FrameCounts& travelled);

/// What a rank does instead that cannot even begin.
void refuse_to_draw(Communicator& communicator);

/// Whether the next image is drawn in bands: measured, not predicted. What is not done is tried now and then,
/// where compositing takes a part of the time that is worth it.
class OverlapChoice {
 public:
  explicit OverlapChoice(Overlap wish) : wish_(wish) {}

  bool next() const;
  /// `seconds` from the order to the image, of these `composite_seconds` after the slowest rank had drawn.
  void took(bool overlapped, std::uint64_t samples, double seconds, double composite_seconds);

 private:
  struct Way {
    std::optional<double> seconds_per_sample;
    int images_ago = 0;
  };

  Overlap wish_;
  Way apart_, overlapped_;
  double composite_share_ = 0;  ///< of images that were drawn first
};

}  // namespace understudy::compositor
