// SPDX-License-Identifier: Apache-2.0
// Volumes as stacks of 2-D textures: what there is to see of them before anything is drawn.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Many 2-D textures in a row that get one size.
class StackDetection {
 public:
  /// Whether a texture of this size may be the next of a row.
  bool continues(GLsizei width, GLsizei height);
  /// The next of the row has been defined; true when there are enough to be a volume.
  bool add(GLuint texture);

 private:
  GLsizei width_ = 0;
  GLsizei height_ = 0;
  GLuint last_ = 0;
  int length_ = 0;
};

/// Slots of the plain phase, which tell the volume unit of such rows.
void fill_stack_detection_slots(DispatchTable& table);

}  // namespace understudy::spu
