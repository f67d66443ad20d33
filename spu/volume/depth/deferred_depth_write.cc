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
                                              // Framebuffers that change may give their depth texture away.
                                              "glBindFramebuffer", "glFramebuffer", "glNamedFramebuffer",
                                              "glGetTexImage", "glGetnTexImage", "glGetTextureImage",
                                              "glGetTextureSubImage"};

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
    if (!draw || observer.context().gl->IsEnabled(GL_DEPTH_TEST)) observer.depth_looked_at();
    return observer.chain().face(observer, Phase::watching);
  }
};

void APIENTRY clear(GLbitfield mask) {
  DrawObserver& observer = here();
  if ((mask & GL_DEPTH_BUFFER_BIT) != 0) observer.depth_cleared();
  observer.next().Clear(mask);
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
  table.ReadPixels = read_pixels;
  table.BlitFramebuffer = blit_framebuffer;
}

}  // namespace understudy::spu
