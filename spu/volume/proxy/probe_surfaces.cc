// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/probe_surfaces.h"

#include <algorithm>

namespace understudy::spu {
namespace {

/// A viewer with several windows has as many sizes; a window that is resized leaves old ones behind.
constexpr std::size_t most_far_planes = 4;

}  // namespace

ProbeSurfaces::~ProbeSurfaces() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(1, &colour_);
  gl_.DeleteRenderbuffers(1, &depth_);
  for (const FarPlane& plane : far_planes_) gl_.DeleteTextures(1, &plane.texture);
}

GLuint ProbeSurfaces::bind_framebuffer(int width, int height) {
  const bool fits = framebuffer_ != 0 && extent_[0] >= width && extent_[1] >= height;
  if (framebuffer_ == 0) {
    gl_.GenRenderbuffers(1, &colour_);
    gl_.GenRenderbuffers(1, &depth_);
    gl_.GenFramebuffers(1, &framebuffer_);
  }
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (!fits) {
    // Growing only: windows of several shapes take turns.
    extent_ = {std::max(extent_[0], width), std::max(extent_[1], height)};
    GLint application_renderbuffer = 0;
    gl_.GetIntegerv(GL_RENDERBUFFER_BINDING, &application_renderbuffer);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, colour_);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, extent_[0], extent_[1]);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, extent_[0], extent_[1]);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, GLuint(application_renderbuffer));
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    complete_ = gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }
  return complete_ ? framebuffer_ : 0;
}

void ProbeSurfaces::bind_far_plane(int width, int height) {
  const std::array<int, 2> size{width, height};
  const auto known = std::ranges::find(far_planes_, size, &FarPlane::size);
  if (known != far_planes_.end()) {
    gl_.BindTexture(GL_TEXTURE_2D, known->texture);
    return;
  }
  if (far_planes_.size() == most_far_planes) {
    gl_.DeleteTextures(1, &far_planes_.front().texture);
    far_planes_.erase(far_planes_.begin());
  }
  const std::vector<float> farthest(std::size_t(width) * std::size_t(height), 1.0F);
  GLuint texture = 0;
  gl_.GenTextures(1, &texture);
  gl_.BindTexture(GL_TEXTURE_2D, texture);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 farthest.data());
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  far_planes_.push_back({size, texture});
}

}  // namespace understudy::spu
