// SPDX-License-Identifier: Apache-2.0
// The vertices of a run as the application gave them to the fixed-function pipeline, whether one by one, in
// arrays, buffers or display lists, and drawn again from memory.
//
// In feedback mode Mesa keeps every buffer that it draws from for ever: the one of glBegin and glEnd (0.5 MiB a
// context), the application's own, and those of its display lists. What it draws from memory it does not keep.
// So transform feedback, which keeps nothing, tells the vertices first.
#pragma once

#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

class GivenVertices {
 public:
  explicit GivenVertices(const GlContext& context) : context_(context) {}

  /// The vertices of `run`, three a triangle. Empty where the run's own calls are needed to draw the same.
  /// The current attributes become those that the run leaves.
  std::vector<float> read(const Run& run);
  /// Draws what `read` gave for `run`, with the state as it is. A glPassThrough with its number stands before
  /// each slice of a stack.
  void draw(const Run& run, const std::vector<float>& vertices) const;

 private:
  bool can_tell(const Run& run) const;
  bool prepare();

  const GlContext& context_;
  GLuint program_ = 0;
  bool has_failed_ = false;  ///< to be made
};

}  // namespace understudy::spu
