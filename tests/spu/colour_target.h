// SPDX-License-Identifier: Apache-2.0
// A framebuffer object of a colour format of the test's choice, with depth, as large as the application's
// framebuffer.
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

  /// False where the driver cannot draw into the format.
  bool complete() const { return complete_; }
  void clear(const std::array<float, 4>& colour) const;
  /// All pixels, RGBA, in float; samples are resolved.
  std::vector<float> read() const;

 private:
  GlApplication& app_;
  bool multisampled_;
  bool complete_ = false;
  std::array<GLuint, 2> framebuffers_{};  ///< the second resolves the samples of the first
  std::array<GLuint, 3> buffers_{};       ///< colour, depth, resolved colour
};

}  // namespace understudy::spu::testing
