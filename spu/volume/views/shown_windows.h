// SPDX-License-Identifier: Apache-2.0
// The windows of the process that show volumes: the number of the frame that each of them is about to show, and
// the views in which it shows a late image (`--frame-latency`).
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "spu/volume/views/view.h"

namespace understudy::spu {

/// What of a window is late after a frame.
enum class LateViews : std::uint8_t {
  none,
  of_this_frame,
  of_earlier_frames,  ///< a view shows an image of an earlier frame, and was not drawn in this one
};

/// Thread-safe. The window 0 is none: its frames are not counted.
class ShownWindows {
 public:
  /// Returns the number of the frame that is being drawn into the window; the next frame has the next number.
  /// Only swaps of the whole window end frames: after a part was copied, the next draw may be of another part.
  std::uint64_t frame(std::uintptr_t window) const;
  /// Whether the window can be asked to redraw itself, as of its latest frame. Images may be late only then.
  bool can_be_redrawn(std::uintptr_t window) const;

  /// An image, or the application's own drawing, has been put into the view.
  void shown(const View& view, bool late);
  /// The window shows the frame that was drawn.
  LateViews frame_ended(std::uintptr_t window, bool can_be_redrawn);
  /// The window has been asked to redraw itself. Views that it does not draw in the next two frames do not
  /// show a volume any more.
  void asked(std::uintptr_t window);

 private:
  struct LateView {
    View view;
    std::uint64_t frame;
    int frames_after_asking = -1;  ///< negative: the window has not been asked
  };
  struct Window {
    std::uintptr_t window = 0;
    std::uint64_t frame = 0;
    bool can_be_redrawn = false;
    std::vector<LateView> late{};
  };

  const Window* find(std::uintptr_t window) const;
  Window* find(std::uintptr_t window);
  Window& of(std::uintptr_t window);

  mutable std::mutex mutex_;
  std::vector<Window> windows_;  ///< the latest last
  std::uint64_t last_frame_ = 0;
};

}  // namespace understudy::spu
