// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/canvas.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace adversary {

Canvas::Canvas(Profile profile, Precision precision, int width, int height)
    : window_(profile, width, height), gl(load_gl()), precision_(precision), width_(width), height_(height) {
  if (exact()) create_exact_framebuffer();
}

void Canvas::create_exact_framebuffer() {
  gl.GenFramebuffers(1, &framebuffer_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  GLuint buffers[2];
  gl.GenRenderbuffers(2, buffers);
  const auto attach = [&](GLuint name, GLenum format, GLenum attachment) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, name);
    gl.RenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, name);
  };
  attach(buffers[0], GL_RGBA32F, GL_COLOR_ATTACHMENT0);
  attach(buffers[1], GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL_ATTACHMENT);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("this OpenGL cannot draw into a framebuffer of 32-bit floats");
}

void Canvas::begin(float red, float green, float blue, float alpha) const {
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.Viewport(0, 0, width_, height_);
  gl.ClearColor(red, green, blue, alpha);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
}

void Canvas::resize(int width, int height) {
  width_ = width;
  height_ = height;
  window_.resize(width, height);
  if (exact()) create_exact_framebuffer();
}

std::vector<std::uint8_t> Canvas::read() const {
  const std::size_t values = std::size_t{4} * width_ * height_;
  std::vector<std::uint8_t> pixels(values);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  if (!exact()) {
    gl.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
  }
  std::vector<float> floats(values);
  gl.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, floats.data());
  std::transform(floats.begin(), floats.end(), pixels.begin(), [](float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
  });
  return pixels;
}

}  // namespace adversary
