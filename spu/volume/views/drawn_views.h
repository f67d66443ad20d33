// SPDX-License-Identifier: Apache-2.0
// The views that one context draws, and how often in each frame. If an application draws two views of a volume
// with the same state in one frame (both eyes of a stereo image that it puts together itself), the first draw
// of the next frame may be either of them: neither can be told from the other.
#pragma once

#include <cstdint>
#include <vector>

#include "spu/volume/views/view.h"

namespace understudy::spu {

/// Frames are numbered by window (ShownWindows).
class DrawnViews {
 public:
  /// Sets the X window that the context draws into from now on; 0: none.
  void draws_into(std::uintptr_t window) { window_ = window; }
  std::uintptr_t window() const { return window_; }

  /// Called for every draw of a volume that may be substituted, whoever draws it in the end.
  void drawn(const View& view, std::uint64_t frame);
  /// Called where the application draws the volume of `texture` in a view that is not known.
  void drawn_somewhere(GLuint texture, std::uint64_t frame);

  /// Whether the view was drawn once in `frame` so far and once in the frame before, and can be told from all
  /// other views of its volume.
  bool stands_alone(const View& view, std::uint64_t frame) const;

 private:
  struct Drawn {
    View view;
    std::uint64_t frame = 0;  ///< the latest in which it was drawn
    bool in_frame_before = false;
    std::uint64_t repeated_in = 0;  ///< the latest frame in which it was drawn twice; 0: none
  };
  struct Unknown {
    GLuint texture;
    std::uintptr_t window;
    std::uint64_t frame;
  };

  std::uintptr_t window_ = 0;
  std::vector<Drawn> views_;  ///< the latest last
  std::vector<Unknown> unknown_;
};

}  // namespace understudy::spu
