// SPDX-License-Identifier: Apache-2.0
// A framebuffer object with a chosen colour format and depth, of the size of the application's framebuffer.
#pragma once

#include <array>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

class ColourTarget {
 public:
  /// `samples` 0: not multisampled. Leaves the framebuffer bound for drawing and reading.
  ColourTarget(GlApplication& app, GLenum internal_format, int samples = 0);
  ~ColourTarget();
  ColourTarget(const ColourTarget&) = delete;
  ColourTarget& operator=(const ColourTarget&) = delete;

  /// False if the driver cannot render to the format.
  bool complete() const { return complete_; }
  void clear(const std::array<float, 4>& colour) const;
  /// All pixels as RGBA floats; multisampled buffers are resolved.
  std::vector<float> read() const;

 private:
  GlApplication& app_;
  bool multisampled_;
  bool complete_ = false;
  std::array<GLuint, 2> framebuffers_{};  ///< the second one resolves the samples of the first
  std::array<GLuint, 3> buffers_{};       ///< colour, depth, resolved colour
};

}  // namespace understudy::spu::testing
