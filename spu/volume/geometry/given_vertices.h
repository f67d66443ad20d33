// SPDX-License-Identifier: Apache-2.0
// The vertices of a run as the application passed them to the fixed-function pipeline (one by one, in arrays,
// buffers or display lists), read and drawn again from memory.
//
// In feedback mode Mesa never frees a buffer that it draws from: that of glBegin and glEnd (0.5 MiB per
// context), the application's own, and those of its display lists. It keeps nothing when it draws from memory.
// Transform feedback, which keeps nothing either, therefore reads the vertices first.
#pragma once

#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

class GivenVertices {
 public:
  explicit GivenVertices(const GlContext& context) : context_(context) {}

  /// Returns the vertices of `run`, three per triangle. Empty if only the run's own calls can draw the same.
  /// The current attributes become those that the run leaves.
  std::vector<float> read(const Run& run);
  /// Draws what `read` returned for `run`, with the current state. Calls glPassThrough with the index of the
  /// slice before each slice of a stack.
  void draw(const Run& run, const std::vector<float>& vertices) const;

 private:
  bool can_tell(const Run& run) const;
  bool prepare();

  const GlContext& context_;
  GLuint program_ = 0;
  bool has_failed_ = false;  ///< the program cannot be linked
};

}  // namespace understudy::spu
