// SPDX-License-Identifier: Apache-2.0
// Compositing while drawing: an image is drawn in bands of rows, and each band is composited while the next one
// is drawn, so that a slow network costs little more than its last band. Nearer ranks do not tell farther ones
// of opaque tiles meanwhile: all draw the same band at the same time, and control messages would come too late.
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

/// Divides `rect` from the bottom up into at most 8 bands of 64 Ki pixels or more (the last may have fewer),
/// which begin at multiples of 16 rows above its lowest row.
std::vector<volume::Rect> bands_of(const volume::Rect& rect);

/// Draws and composites an image band by band; collective. `draw` returns this rank's image of a band, or null
/// if it cannot go on: then all ranks give up after the same band. `whole` is the rectangle that the image
/// buffer holds afterwards, the same on all ranks; all that is drawn lies in it. Returns whether the image is
/// complete; adds to `travelled` as Compositing::composite() does. Meanwhile threads other than the caller's
/// use the communicator, one at a time. Throws what an exchange throws: this rank is then out of step with the
/// others, and must not go on.
bool draw_and_composite(Communicator& communicator, Compositing& compositing, const ImageTask& task,
                        const ImageBuffers::Memory& memory, const volume::Rect& whole,
                        const std::function<std::optional<volume::Image>(const volume::Rect& band)>& draw,
                        volume::FrameCounts& travelled);

/// Called instead by a rank that cannot even begin.
void refuse_to_draw(Communicator& communicator);

/// Decides whether the next image is drawn in bands, by measured times. The way not in use is tried now and
/// then, if compositing takes a large enough part of the time.
class OverlapChoice {
 public:
  explicit OverlapChoice(Overlap wish) : wish_(wish) {}

  bool next() const;
  /// `seconds` from the order to the image, `composite_seconds` of them after the slowest rank had drawn.
  void took(bool overlapped, std::uint64_t samples, double seconds, double composite_seconds);

 private:
  struct Way {
    std::optional<double> seconds_per_sample;
    int images_ago = 0;
  };

  Overlap wish_;
  Way apart_, overlapped_;
  double composite_share_ = 0;  ///< of images that were not overlapped
};

}  // namespace understudy::compositor
