// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/deferred_depth_write.h"

#include <array>
#include <string_view>

#include "dispatch/pass_through.h"
#include "spu/track/call_names.h"
#include "spu/track/calls.h"
#include "spu/volume/observation/draw_observer.h"
#include "spu/volume/observation/draw_slots.h"

namespace understudy::spu {
namespace {

DrawObserver& here() {
  return *Chain::current()->find<DrawObserver>();
}

constexpr std::string_view depth_readers[] = {"glReadPixels", "glReadnPixels", "glCopyPixels", "glCopyTex",
                                              "glCopyImageSubData", "glBlit", "glDrawPixels", "glBitmap",
                                              // Framebuffers that change may give their depth away.
                                              "glFramebuffer", "glNamedFramebuffer", "glGetTexImage",
                                              "glGetnTexImage", "glGetTextureImage", "glGetTextureSubImage"};

GLuint bound(const DispatchTable& gl, GLenum binding) {
  GLint framebuffer = 0;
  gl.GetIntegerv(binding, &framebuffer);
  return GLuint(framebuffer);
}

GLuint bound_for_drawing(const DispatchTable& gl) {
  return bound(gl, GL_DRAW_FRAMEBUFFER_BINDING);
}

/// A draw with a depth test, or a read: the answer would depend on the deferred depth.
struct NoteDepthUse {
  static constexpr bool chooses(std::string_view name) {
    if (name == "glEnd") return false;
    return is_draw(name) || name == "glCallList" || name == "glCallLists" ||
           starts_with_any(name, depth_readers);
  }
  static const DispatchTable& before(CallId call) {
    DrawObserver& observer = here();
    // Within glBegin and glEnd nothing may be asked, and glBegin has been looked at.
    if (observer.inside_begin) return observer.chain().face(observer, Phase::watching);
    const bool draw = kind_of(call) == CallKind::draw || call == CallId::CallList || call == CallId::CallLists;
    const DispatchTable& gl = *observer.context().gl;
    if (!draw)
      observer.depth_looked_at();
    else if (gl.IsEnabled(GL_DEPTH_TEST))
      observer.depth_looked_at_in(bound_for_drawing(gl));
    return observer.chain().face(observer, Phase::watching);
  }
};

void APIENTRY clear(GLbitfield mask) {
  DrawObserver& observer = here();
  if ((mask & GL_DEPTH_BUFFER_BIT) != 0) observer.depth_cleared_in(bound_for_drawing(*observer.context().gl));
  observer.next().Clear(mask);
}

void note_framebuffer(GLenum target, GLuint framebuffer) {
  DrawObserver& observer = here();
  if (target != GL_READ_FRAMEBUFFER && !observer.inside_begin) observer.framebuffer_bound(framebuffer);
}

void APIENTRY bind_framebuffer(GLenum target, GLuint framebuffer) {
  note_framebuffer(target, framebuffer);
  here().next().BindFramebuffer(target, framebuffer);
}

void APIENTRY bind_framebuffer_ext(GLenum target, GLuint framebuffer) {
  note_framebuffer(target, framebuffer);
  here().next().BindFramebufferEXT(target, framebuffer);
}

/// The framebuffer that is bound gets another image; its old one may be looked at in another way.
void note_attachment(GLenum target, GLuint renderbuffer) {
  DrawObserver& observer = here();
  if (observer.inside_begin) return;
  observer.depth_looked_at_in(bound(*observer.context().gl, target == GL_READ_FRAMEBUFFER
                                                                ? GL_READ_FRAMEBUFFER_BINDING
                                                                : GL_DRAW_FRAMEBUFFER_BINDING));
  observer.renderbuffer_attached(renderbuffer);
}

void APIENTRY framebuffer_renderbuffer(GLenum target, GLenum attachment, GLenum renderbuffer_target,
                                       GLuint renderbuffer) {
  note_attachment(target, renderbuffer);
  here().next().FramebufferRenderbuffer(target, attachment, renderbuffer_target, renderbuffer);
}

void APIENTRY framebuffer_renderbuffer_ext(GLenum target, GLenum attachment, GLenum renderbuffer_target,
                                           GLuint renderbuffer) {
  note_attachment(target, renderbuffer);
  here().next().FramebufferRenderbufferEXT(target, attachment, renderbuffer_target, renderbuffer);
}

void APIENTRY framebuffer_texture_2d(GLenum target, GLenum attachment, GLenum texture_target, GLuint texture,
                                     GLint level) {
  note_attachment(target, 0);
  here().next().FramebufferTexture2D(target, attachment, texture_target, texture, level);
}

void use_depth(bool used) {
  DrawObserver& observer = here();
  if (used && !observer.inside_begin) observer.depth_looked_at();
}

void APIENTRY read_pixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
                          void* pixels) {
  use_depth(format == GL_DEPTH_COMPONENT || format == GL_DEPTH_STENCIL);
  DrawObserver& observer = here();
  observer.chain().face(observer, Phase::watching).ReadPixels(x, y, width, height, format, type, pixels);
}

void APIENTRY blit_framebuffer(GLint x0, GLint y0, GLint x1, GLint y1, GLint to_x0, GLint to_y0, GLint to_x1,
                               GLint to_y1, GLbitfield mask, GLenum filter) {
  use_depth((mask & GL_DEPTH_BUFFER_BIT) != 0);
  DrawObserver& observer = here();
  observer.chain()
      .face(observer, Phase::watching)
      .BlitFramebuffer(x0, y0, x1, y1, to_x0, to_y0, to_x1, to_y1, mask, filter);
}

}  // namespace

void write_depth(const DispatchTable& gl, const Run& run) {
  std::array<GLboolean, 4> mask{};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, mask.data());
  gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  run.replay(gl);
  gl.ColorMask(mask[0], mask[1], mask[2], mask[3]);
}

void fill_depth_deferred_slots(DispatchTable& table) {
  fill_watching_slots(table);
  PassThrough<NoteDepthUse>::fill_chosen(table);
  table.Clear = clear;
  table.BindFramebuffer = bind_framebuffer;
  table.BindFramebufferEXT = bind_framebuffer_ext;
  table.FramebufferRenderbuffer = framebuffer_renderbuffer;
  table.FramebufferRenderbufferEXT = framebuffer_renderbuffer_ext;
  table.FramebufferTexture2D = framebuffer_texture_2d;
  table.ReadPixels = read_pixels;
  table.BlitFramebuffer = blit_framebuffer;
}

}  // namespace understudy::spu
