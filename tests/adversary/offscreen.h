// SPDX-License-Identifier: Apache-2.0
// A framebuffer object of the canvas's size, and its way into the window.
#pragma once

#include "tests/adversary/glsl_program.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary {

class Offscreen {
 public:
  /// `samples` above 1: a multisampled one, which is resolved before it is shown.
  Offscreen(const Canvas& canvas, GLenum format, int samples = 1);

  /// A renderbuffer of its own, of this format: depth, or depth and stencil.
  void attach_depth(GLenum format) const;

  GLuint framebuffer() const { return framebuffer_; }
  /// Binds it and clears it.
  void begin(float red, float green, float blue, float alpha) const;
  /// As a texture over the whole window, opaque.
  void show() const;

 private:
  const Canvas& canvas_;
  GLuint framebuffer_ = 0;
  GLuint resolved_ = 0;  ///< framebuffer of `texture_`; the same where there is one sample
  GLuint texture_ = 0;
  GlslProgram program_;
  VertexBuffer vertices_;
};

}  // namespace adversary
