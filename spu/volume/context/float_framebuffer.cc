// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/context/float_framebuffer.h"

#include <algorithm>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"

namespace understudy::spu {
namespace {

/// Row by row; 1 where there is no `depth`.
std::vector<float> depth_in(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth) {
  std::vector<float> depths(rect.pixels(), 1.0F);
  if (!depth) return depths;
  const volume::Rect both = intersection(rect, depth->rect);
  for (int y = both.y; y < both.y + both.height; ++y) {
    const auto from =
        depth->depth.begin() + std::ptrdiff_t(y - depth->rect.y) * depth->rect.width + (both.x - depth->rect.x);
    std::copy_n(from, both.width, depths.begin() + std::ptrdiff_t(y - rect.y) * rect.width + (both.x - rect.x));
  }
  return depths;
}

}  // namespace

FloatFramebuffer::FloatFramebuffer(const GlContext& context, int width, int height, int samples,
                                   const std::optional<volume::DepthImage>& depth, float background)
    : context_(context), width_(width), height_(height), multisampled_(samples > 0) {
  const DispatchTable& gl = *context_.gl;
  SavedState saved(context_);
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.GenTextures(2, textures_.data());
  gl.BindTexture(GL_TEXTURE_2D, textures_[0]);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.BindTexture(GL_TEXTURE_2D, textures_[1]);
  const std::vector<float> far(std::size_t(width) * std::size_t(height), 1.0F);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                far.data());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  if (depth) {
    // A viewport may reach beyond the framebuffer.
    const volume::Rect part = intersection(depth->rect, {0, 0, width, height});
    const std::vector<float> depths = depth_in(part, depth);
    if (!part.empty())
      gl.TexSubImage2D(GL_TEXTURE_2D, 0, part.x, part.y, part.width, part.height, GL_DEPTH_COMPONENT, GL_FLOAT,
                       depths.data());
  }
  gl.GenFramebuffers(1, framebuffers_.data());
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[0]);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures_[0], 0);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, textures_[1], 0);
  complete_ = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (complete_ && multisampled_) add_samples(samples);
  const std::array<float, 4> cleared{background, background, background, background};
  if (complete_) gl.ClearBufferfv(GL_COLOR, 0, cleared.data());
}

void FloatFramebuffer::add_samples(int samples) {
  const DispatchTable& gl = *context_.gl;
  GLint bound = 0;
  gl.GetIntegerv(GL_RENDERBUFFER_BINDING, &bound);
  gl.GenRenderbuffers(2, buffers_.data());
  gl.GenFramebuffers(1, &framebuffers_[1]);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffers_[1]);
  const auto attach = [&](GLenum attachment, GLuint buffer, GLenum format) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width_, height_);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  };
  attach(GL_COLOR_ATTACHMENT0, buffers_[0], GL_RGBA32F);
  attach(GL_DEPTH_ATTACHMENT, buffers_[1], GL_DEPTH_COMPONENT32F);
  gl.BindRenderbuffer(GL_RENDERBUFFER, GLuint(bound));
  complete_ = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (complete_) blit(framebuffers_[0], framebuffers_[1], GL_DEPTH_BUFFER_BIT);
}

void FloatFramebuffer::blit(GLuint from, GLuint to, GLbitfield what) const {
  const DispatchTable& gl = *context_.gl;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, from);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  gl.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, what, GL_NEAREST);
}

void FloatFramebuffer::clear(const volume::Rect& rect, const std::optional<volume::DepthImage>& depth,
                             float background) {
  const DispatchTable& gl = *context_.gl;
  SavedState saved(context_);
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, textures_[1]);
  const std::vector<float> depths = depth_in(rect, depth);
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, rect.x, rect.y, rect.width, rect.height, GL_DEPTH_COMPONENT, GL_FLOAT,
                   depths.data());
  std::array<GLint, 4> box{};
  gl.GetIntegerv(GL_SCISSOR_BOX, box.data());
  gl.Enable(GL_SCISSOR_TEST);
  gl.Scissor(rect.x, rect.y, rect.width, rect.height);
  if (multisampled_) blit(framebuffers_[0], framebuffers_[1], GL_DEPTH_BUFFER_BIT);
  gl.BindFramebuffer(GL_FRAMEBUFFER, name());
  const std::array<float, 4> cleared{background, background, background, background};
  gl.ClearBufferfv(GL_COLOR, 0, cleared.data());
  gl.Scissor(box[0], box[1], box[2], box[3]);
  gl.Disable(GL_SCISSOR_TEST);
}

std::vector<float> FloatFramebuffer::pixels(const volume::Rect& rect) const {
  const DispatchTable& gl = *context_.gl;
  std::vector<float> rgba(4 * rect.pixels());
  const SavedState saved(context_);
  if (multisampled_) blit(framebuffers_[1], framebuffers_[0], GL_COLOR_BUFFER_BIT);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[0]);
  gl.ReadPixels(rect.x, rect.y, rect.width, rect.height, GL_RGBA, GL_FLOAT, rgba.data());
  return rgba;
}

FloatFramebuffer::~FloatFramebuffer() {
  const DispatchTable& gl = *context_.gl;
  gl.DeleteFramebuffers(2, framebuffers_.data());
  gl.DeleteRenderbuffers(2, buffers_.data());
  gl.DeleteTextures(2, textures_.data());
}

}  // namespace understudy::spu
