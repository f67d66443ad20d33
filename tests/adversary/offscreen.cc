// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/offscreen.h"

#include <array>
#include <stdexcept>

#include "tests/adversary/textures.h"

namespace adversary {
namespace {

constexpr auto vertex = R"(#version 330 core
in vec3 position;
out vec2 at;
void main() {
  at = 0.5 * position.xy + 0.5;
  gl_Position = vec4(position, 1.0);
}
)";

constexpr auto fragment = R"(#version 330 core
uniform sampler2D image;
in vec2 at;
out vec4 shown;
void main() { shown = vec4(texture(image, at).rgb, 1.0); }
)";

constexpr int unit = 7;

}  // namespace

Offscreen::Offscreen(const Canvas& canvas, GLenum format, int samples)
    : canvas_(canvas), program_(canvas, vertex, fragment), vertices_(canvas) {
  const Gl& gl = canvas.gl;
  gl.GenTextures(1, &texture_);
  gl.ActiveTexture(GL_TEXTURE0 + unit);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(canvas.colour_format(format)), canvas.width(),
                canvas.height(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl.GenFramebuffers(1, &resolved_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, resolved_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  framebuffer_ = resolved_;
  if (samples > 1) {
    gl.GenFramebuffers(1, &framebuffer_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    GLuint colours = 0;
    gl.GenRenderbuffers(1, &colours);
    gl.BindRenderbuffer(GL_RENDERBUFFER, colours);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, canvas.colour_format(format), canvas.width(),
                                      canvas.height());
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colours);
  }
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("this OpenGL cannot draw into a framebuffer object of the format");
}

void Offscreen::attach_depth(GLenum format) const {
  const Gl& gl = canvas_.gl;
  GLuint depth = 0;
  gl.GenRenderbuffers(1, &depth);
  gl.BindRenderbuffer(GL_RENDERBUFFER, depth);
  gl.RenderbufferStorage(GL_RENDERBUFFER, format, canvas_.width(), canvas_.height());
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  const GLenum attachment = format == GL_DEPTH24_STENCIL8 ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT;
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, depth);
}

void Offscreen::begin(float red, float green, float blue, float alpha) const {
  canvas_.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  canvas_.gl.Viewport(0, 0, canvas_.width(), canvas_.height());
  canvas_.gl.ClearColor(red, green, blue, alpha);
  canvas_.gl.Clear(GL_COLOR_BUFFER_BIT);
}

void Offscreen::show() const {
  const Gl& gl = canvas_.gl;
  if (resolved_ != framebuffer_) {
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
    gl.BlitFramebuffer(0, 0, canvas_.width(), canvas_.height(), 0, 0, canvas_.width(), canvas_.height(),
                       GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  canvas_.begin();
  gl.Disable(GL_BLEND);
  gl.ActiveTexture(GL_TEXTURE0 + unit);
  gl.BindTexture(GL_TEXTURE_2D, texture_);
  program_.use();
  program_.set("image", unit);
  vertices_.draw(std::array<Vector, 4>{Vector{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}},
                 GL_TRIANGLE_STRIP);
}

}  // namespace adversary
