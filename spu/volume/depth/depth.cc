// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/depth.h"

#include <algorithm>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"

namespace understudy::spu {
namespace {

/// Returns the depth format of the framebuffer object bound for drawing. Its samples can be resolved only into
/// a framebuffer of the same format.
GLenum depth_format(const DispatchTable& gl) {
  const auto parameter = [&](GLenum attachment, GLenum name) {
    GLint value = 0;
    gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, name, &value);
    return value;
  };
  const auto exists = [&](GLenum attachment) {
    return parameter(attachment, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_NONE;
  };
  if (!exists(GL_DEPTH_ATTACHMENT)) return GL_NONE;
  const bool both = exists(GL_STENCIL_ATTACHMENT);
  if (parameter(GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT)
    return both ? GL_DEPTH32F_STENCIL8 : GL_DEPTH_COMPONENT32F;
  switch (parameter(GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE)) {
    case 16:
      return GL_DEPTH_COMPONENT16;
    case 32:
      return GL_DEPTH_COMPONENT32;
    default:
      return both ? GL_DEPTH24_STENCIL8 : GL_DEPTH_COMPONENT24;
  }
}

/// A framebuffer of the rectangle's size with the depth of one sample per pixel, bound for reading.
class ResolvedDepth {
 public:
  /// The multisampled framebuffer must be bound for reading; `format` is its depth format.
  ResolvedDepth(const DispatchTable& gl, const volume::Rect& rect, GLenum format) : gl_(gl) {
    GLint bound = 0;
    gl_.GetIntegerv(GL_RENDERBUFFER_BINDING, &bound);
    gl_.GenRenderbuffers(1, &buffer_);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer_);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, format, rect.width, rect.height);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, GLuint(bound));
    gl_.GenFramebuffers(1, &framebuffer_);
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
    gl_.FramebufferRenderbuffer(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffer_);
    gl_.DrawBuffer(GL_NONE);
    gl_.BlitFramebuffer(rect.x, rect.y, rect.x + rect.width, rect.y + rect.height, 0, 0, rect.width,
                        rect.height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    gl_.ReadBuffer(GL_NONE);
  }
  ~ResolvedDepth() {
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteRenderbuffers(1, &buffer_);
  }
  ResolvedDepth(const ResolvedDepth&) = delete;
  ResolvedDepth& operator=(const ResolvedDepth&) = delete;

 private:
  const DispatchTable& gl_;
  GLuint framebuffer_ = 0;
  GLuint buffer_ = 0;
};

}  // namespace

std::optional<volume::DepthImage> read_depth(const GlContext& context, const Target& target,
                                             const volume::Rect& rect, bool or_equal) {
  if (rect.empty()) return std::nullopt;
  const DispatchTable& gl = *context.gl;
  volume::DepthImage image;
  image.rect = rect;
  image.or_equal = or_equal;
  image.depth.assign(rect.pixels(), 1.0F);
  {
    const SavedState saved(context);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, saved.draw_framebuffer());
    // Pixels can be read from a multisampled window, but a multisampled framebuffer object must be resolved
    // first.
    const bool resolve = target.samples > 0 && saved.draw_framebuffer() != 0;
    const GLenum format = resolve ? depth_format(gl) : GLenum(GL_NONE);
    if (resolve && format == GL_NONE) return std::nullopt;
    std::optional<ResolvedDepth> resolved;
    if (resolve) resolved.emplace(gl, rect, format);
    gl.ReadPixels(resolve ? 0 : rect.x, resolve ? 0 : rect.y, rect.width, rect.height, GL_DEPTH_COMPONENT,
                  GL_FLOAT, image.depth.data());
  }
  return image;
}

bool hides_nothing(const volume::DepthImage& image) {
  return std::all_of(image.depth.begin(), image.depth.end(), [](float d) { return d >= 1.0F; });
}

}  // namespace understudy::spu
