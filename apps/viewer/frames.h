// SPDX-License-Identifier: Apache-2.0
// Draws frame after frame: orbit, times, screenshots and the description of the last frame. Used by both the
// window and the off-screen loop.
#pragma once

#include <functional>
#include <vector>

#include "apps/viewer/options.h"
#include "apps/viewer/scene.h"

namespace viewer {

class Frames {
 public:
  Frames(const Options& options, Scene& scene) : options_(options), scene_(scene) {}

  /// Draws the next frame and calls `present` to end it (swap). Rotates `camera` by the orbit so far.
  void draw_next(Camera camera, int width, int height, const std::function<void()>& present);

  bool finished() const { return options_.frames > 0 && drawn_ >= options_.frames; }

  /// Prints the median of the frame times if they are printed. Call once, at the end.
  void print_median() const;

 private:
  const Options& options_;
  Scene& scene_;
  int drawn_ = 0;
  std::vector<double> milliseconds_;
};

}  // namespace viewer
