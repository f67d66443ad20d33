// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/deferred_depth_write.h"

#include <array>
#include <optional>
#include <string_view>

#include "dispatch/pass_through.h"
#include "spu/state_value.h"
#include "spu/track/call_names.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "spu/volume/depth/depth_attachment.h"
#include "spu/volume/observation/draw_observer.h"
#include "spu/volume/observation/draw_slots.h"

namespace understudy::spu {
namespace {

constexpr std::string_view depth_readers[] = {
    "glReadPixels", "glReadnPixels", "glCopyPixels", "glCopyTex", "glCopyImageSubData", "glBlit",
    "glDrawPixels", "glBitmap",
    // After a change of attachments, the depth may be readable elsewhere.
    "glFramebuffer", "glNamedFramebuffer", "glGetTexImage", "glGetnTexImage", "glGetTextureImage",
    "glGetTextureSubImage",
    // Draws that no volume consists of, and commands that sample textures without a draw.
    "glDrawTransformFeedback", "glDrawMeshTasks", "glDrawCommands", "glCallCommandList", "glDispatchCompute"};

GLuint bound(const DispatchTable& gl, GLenum binding) {
  return GLuint(state_value(gl, binding));
}

void note_draw(DrawObserver& observer) {
  const DispatchTable& gl = *observer.context().gl;
  observer.depth_looked_at(observer.deferred_depth.take_textures(std::nullopt));
  if (observer.deferred_depth.empty() || !gl.IsEnabled(GL_DEPTH_TEST)) return;
  const GLuint framebuffer = bound(gl, GL_DRAW_FRAMEBUFFER_BINDING);
  observer.depth_looked_at(
      observer.deferred_depth.take(framebuffer, depth_attachment(gl, framebuffer).renderbuffer()));
}

/// A draw with a depth test, or a read: its result would depend on the deferred depth.
struct NoteDepthUse {
  static constexpr bool chooses(std::string_view name) {
    if (name == "glEnd") return false;
    return is_draw(name) || name == "glCallLists" || starts_with_any(name, depth_readers);
  }
  static const DispatchTable& before(CallId call) {
    DrawObserver& observer = DrawObserver::current();
    // Queries are not allowed between glBegin and glEnd, and glBegin itself has been checked.
    if (observer.inside_begin) return observer.chain().face(observer, Phase::watching);
    if (kind_of(call) == CallKind::draw)
      note_draw(observer);
    else
      observer.depth_looked_at(observer.deferred_depth.take_all());
    return observer.chain().face(observer, Phase::watching);
  }
};

/// The table of the watching phase, which handles the call next.
const DispatchTable& watching(DrawObserver& observer) {
  return observer.chain().face(observer, Phase::watching);
}

/// A list that does more than draw may enable the depth test, or bind another framebuffer, before it draws.
void APIENTRY call_list_after_volume(GLuint list) {
  DrawObserver& observer = DrawObserver::current();
  if (!observer.inside_begin) {
    const auto record = observer.chain().group().list(list);
    if (record && record->only_geometry)
      note_draw(observer);
    else
      observer.depth_looked_at(observer.deferred_depth.take_all());
  }
  watching(observer).CallList(list);
}

/// Clears depth within the scissor, if the depth mask allows it.
void APIENTRY clear(GLbitfield mask) {
  DrawObserver& observer = DrawObserver::current();
  const DispatchTable& gl = *observer.context().gl;
  GLboolean writes = GL_FALSE;
  gl.GetBooleanv(GL_DEPTH_WRITEMASK, &writes);
  if ((mask & GL_DEPTH_BUFFER_BIT) != 0 && writes) {
    std::optional<volume::Rect> part;
    if (gl.IsEnabled(GL_SCISSOR_TEST)) {
      std::array<GLint, 4> box{};
      gl.GetIntegerv(GL_SCISSOR_BOX, box.data());
      part = volume::Rect{box[0], box[1], box[2], box[3]};
    }
    const GLuint framebuffer = bound(gl, GL_DRAW_FRAMEBUFFER_BINDING);
    if (!observer.deferred_depth.take_cleared(framebuffer, part).empty()) observer.depth_gone();
  }
  observer.next().Clear(mask);
}

/// What is drawn into another framebuffer may sample a depth texture.
void note_framebuffer(DrawObserver& observer, GLenum target, GLuint framebuffer) {
  if (target != GL_READ_FRAMEBUFFER && !observer.inside_begin)
    observer.depth_looked_at(observer.deferred_depth.take_textures(framebuffer));
}

void APIENTRY bind_framebuffer(GLenum target, GLuint framebuffer) {
  DrawObserver& observer = DrawObserver::current();
  note_framebuffer(observer, target, framebuffer);
  watching(observer).BindFramebuffer(target, framebuffer);
}

void APIENTRY bind_framebuffer_ext(GLenum target, GLuint framebuffer) {
  DrawObserver& observer = DrawObserver::current();
  note_framebuffer(observer, target, framebuffer);
  watching(observer).BindFramebufferEXT(target, framebuffer);
}

/// The bound framebuffer gets another attachment; its old one may be read by other means.
void note_attachment(DrawObserver& observer, GLenum target, GLuint renderbuffer) {
  if (observer.inside_begin) return;
  const GLuint changed =
      bound(*observer.context().gl,
            target == GL_READ_FRAMEBUFFER ? GL_READ_FRAMEBUFFER_BINDING : GL_DRAW_FRAMEBUFFER_BINDING);
  observer.depth_looked_at(observer.deferred_depth.take(changed, renderbuffer));
}

void APIENTRY framebuffer_renderbuffer(GLenum target, GLenum attachment, GLenum renderbuffer_target,
                                       GLuint renderbuffer) {
  DrawObserver& observer = DrawObserver::current();
  note_attachment(observer, target, renderbuffer);
  watching(observer).FramebufferRenderbuffer(target, attachment, renderbuffer_target, renderbuffer);
}

void APIENTRY framebuffer_renderbuffer_ext(GLenum target, GLenum attachment, GLenum renderbuffer_target,
                                           GLuint renderbuffer) {
  DrawObserver& observer = DrawObserver::current();
  note_attachment(observer, target, renderbuffer);
  watching(observer).FramebufferRenderbufferEXT(target, attachment, renderbuffer_target, renderbuffer);
}

void APIENTRY framebuffer_texture_2d(GLenum target, GLenum attachment, GLenum texture_target, GLuint texture,
                                     GLint level) {
  DrawObserver& observer = DrawObserver::current();
  note_attachment(observer, target, 0);
  watching(observer).FramebufferTexture2D(target, attachment, texture_target, texture, level);
}

void use_depth(bool used) {
  DrawObserver& observer = DrawObserver::current();
  if (used && !observer.inside_begin) observer.depth_looked_at(observer.deferred_depth.take_all());
}

void APIENTRY read_pixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type,
                          void* pixels) {
  use_depth(format == GL_DEPTH_COMPONENT || format == GL_DEPTH_STENCIL);
  DrawObserver& observer = DrawObserver::current();
  observer.chain().face(observer, Phase::watching).ReadPixels(x, y, width, height, format, type, pixels);
}

void APIENTRY blit_framebuffer(GLint x0, GLint y0, GLint x1, GLint y1, GLint to_x0, GLint to_y0, GLint to_x1,
                               GLint to_y1, GLbitfield mask, GLenum filter) {
  use_depth((mask & GL_DEPTH_BUFFER_BIT) != 0);
  DrawObserver& observer = DrawObserver::current();
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
  table.CallList = call_list_after_volume;
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
