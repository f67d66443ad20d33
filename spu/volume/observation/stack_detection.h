// SPDX-License-Identifier: Apache-2.0
// Detects volumes that are stacks of 2-D textures before anything is drawn.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Detects many 2-D textures in a row that are defined with one size.
class StackDetection {
 public:
  /// Returns whether a texture of this size may be the next of a row.
  bool continues(GLsizei width, GLsizei height);
  /// Adds the next texture of the row; returns true when there are enough for a volume.
  bool add(GLuint texture);

 private:
  GLsizei width_ = 0;
  GLsizei height_ = 0;
  GLuint last_ = 0;
  int length_ = 0;
};

/// Fills slots of the plain phase that report such rows to the volume unit.
void fill_stack_detection_slots(DispatchTable& table);

}  // namespace understudy::spu
