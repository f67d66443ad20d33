// SPDX-License-Identifier: Apache-2.0
#include "colour_target.h"

namespace understudy::spu::testing {

ColourTarget::ColourTarget(GlApplication& app, GLenum internal_format, int samples)
    : app_(app), multisampled_(samples > 0) {
  constexpr int edge = GlApplication::size;
  const DispatchTable& gl = app_.gl();
  gl.GenFramebuffers(2, framebuffers_.data());
  gl.GenRenderbuffers(3, buffers_.data());
  const auto storage = [&](GLuint buffer, GLenum format, int of_each_pixel) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, of_each_pixel, format, edge, edge);
  };
  storage(buffers_[0], internal_format, samples);
  storage(buffers_[1], GL_DEPTH_COMPONENT24, samples);
  storage(buffers_[2], internal_format, 0);
  const auto attach = [&](GLenum attachment, GLuint buffer) {
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  };
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[1]);
  attach(GL_COLOR_ATTACHMENT0, buffers_[2]);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
  attach(GL_COLOR_ATTACHMENT0, buffers_[0]);
  attach(GL_DEPTH_ATTACHMENT, buffers_[1]);
  complete_ = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

ColourTarget::~ColourTarget() {
  const DispatchTable& gl = app_.gl();
  gl.DeleteFramebuffers(2, framebuffers_.data());
  gl.DeleteRenderbuffers(3, buffers_.data());
}

void ColourTarget::clear(const std::array<float, 4>& colour) const {
  const DispatchTable& gl = app_.gl();
  gl.Viewport(0, 0, GlApplication::size, GlApplication::size);
  gl.ClearColor(colour[0], colour[1], colour[2], colour[3]);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

std::vector<float> ColourTarget::read() const {
  constexpr int edge = GlApplication::size;
  const DispatchTable& gl = app_.gl();
  if (multisampled_) {
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers_[1]);
    gl.BlitFramebuffer(0, 0, edge, edge, 0, 0, edge, edge, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[1]);
  }
  auto pixels = app_.read_pixels();
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
  return pixels;
}

}  // namespace understudy::spu::testing
