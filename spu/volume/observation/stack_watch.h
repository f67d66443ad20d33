// SPDX-License-Identifier: Apache-2.0
// For how long draws through 2-D textures are looked at: they may be the slices of a stack.
#pragma once

#include "spu/volume/observation/stack_detection.h"

namespace understudy::spu {

class StackWatch {
 public:
  StackDetection detection;

  /// Many textures of one size were defined. True where nothing was watched before.
  bool begin();
  /// Whether draws are looked at at all, and whether those through 2-D textures are.
  bool watched() const { return watched_; }
  bool possible() const { return possible_; }
  /// What was drawn through a row of textures was looked at, and is a volume or not. Each look costs a drawing
  /// in feedback mode: whoever draws other things from many textures is soon left alone.
  void looked_at(bool volume);
  /// A frame has ended in which no volume was known. True where that was the last that is waited for: then it
  /// ends.
  bool frame_without_volume();
  /// True where something was watched.
  bool end();

 private:
  bool watched_ = false;
  bool possible_ = false;  ///< while they are watched: rows of textures may still be one
  int frames_without_ = 0;
  int others_ = 0;  ///< runs through many 2-D textures that were no volume, since the last that was
};

}  // namespace understudy::spu
