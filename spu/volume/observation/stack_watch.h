// SPDX-License-Identifier: Apache-2.0
// Limits how long draws through 2-D textures are watched: they may be the slices of a stack.
#pragma once

#include "spu/volume/observation/stack_detection.h"

namespace understudy::spu {

class StackWatch {
 public:
  StackDetection detection;

  /// Called when many textures of one size were defined. Returns true if nothing was watched before.
  bool begin();
  /// Whether draws are watched at all, and whether those through 2-D textures are.
  bool watched() const { return watched_; }
  bool possible() const { return possible_; }
  /// Draws through a row of textures were checked: they are a volume or not. Each check costs a drawing in
  /// feedback mode, so an application that draws other things with many textures is soon no longer watched.
  void looked_at(bool volume);
  /// Called when a frame has ended in which no volume was known. Returns true if watching should end now.
  bool frame_without_volume();
  /// Returns true if something was watched.
  bool end();

 private:
  bool watched_ = false;
  bool possible_ = false;  ///< while watched: rows of textures may still be a stack
  int frames_without_ = 0;
  int others_ = 0;  ///< runs through many 2-D textures that were no volume, since the last that was one
};

}  // namespace understudy::spu
