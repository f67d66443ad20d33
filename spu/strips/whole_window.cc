#include "spu/strips/whole_window.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "spu/player/neutral_pixel_transfer.h"
#include "spu/volume/context.h"
#include "spu/volume/saved_state.h"

namespace understudy::spu {
namespace {

GLint ask(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

/// Of the window, which is bound.
std::pair<GLint, GLint> depth_and_stencil_bits(const DispatchTable& gl) {
  GLint depth = 0;
  GLint stencil = 0;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_DEPTH, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE,
                                         &depth);
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_STENCIL,
                                         GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE, &stencil);
  return {depth, stencil};
}

/// The buffer of the window that a swap shows.
class ShownBuffer {
 public:
  explicit ShownBuffer(const DispatchTable& gl)
      : gl_(gl), read_(ask(gl, GL_READ_BUFFER)), drawn_(ask(gl, GL_DRAW_BUFFER)) {
    const GLenum shown = ask(gl, GL_DOUBLEBUFFER) != 0 ? GL_BACK : GL_FRONT;
    gl_.ReadBuffer(shown);
    gl_.DrawBuffer(shown);
  }
  /// The window is bound again.
  ~ShownBuffer() {
    gl_.ReadBuffer(GLenum(read_));
    gl_.DrawBuffer(GLenum(drawn_));
  }
  ShownBuffer(const ShownBuffer&) = delete;
  ShownBuffer& operator=(const ShownBuffer&) = delete;

 private:
  const DispatchTable& gl_;
  const GLint read_;
  const GLint drawn_;
};

}  // namespace

bool depth_can_be_copied(const DispatchTable& gl) {
  // Blits copy depth between equal formats alone, and textures have this one.
  const auto bits = depth_and_stencil_bits(gl);
  return bits == std::pair{0, 0} || bits == std::pair{24, 8};
}

void complete_window(const DispatchTable& gl, Extent2D extent) {
  SavedState saved(describe_context(gl));
  saved.borrow_texture(GL_TEXTURE_2D, 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  // It keeps the read buffer, too, and therefore the one of the window.
  const NeutralPixelTransfer neutral(gl);
  const ShownBuffer shown(gl);
  const bool has_depth = depth_and_stencil_bits(gl).first > 0;
  std::vector<std::uint32_t> colour(std::size_t(extent.width) * std::size_t(extent.height));
  std::vector<std::uint32_t> depth(has_depth ? colour.size() : 0);
  gl.ReadPixels(0, 0, extent.width, extent.height, GL_RGBA, GL_UNSIGNED_BYTE, colour.data());
  if (has_depth)
    gl.ReadPixels(0, 0, extent.width, extent.height, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, depth.data());

  std::array<GLuint, 2> textures{};
  GLuint framebuffer = 0;
  gl.GenTextures(2, textures.data());
  gl.GenFramebuffers(1, &framebuffer);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  const auto attach = [&](GLuint texture, GLenum attachment, GLint internal_format, GLenum format, GLenum type,
                          const void* pixels) {
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexImage2D(GL_TEXTURE_2D, 0, internal_format, extent.width, extent.height, 0, format, type, pixels);
    gl.FramebufferTexture2D(GL_READ_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
  };
  gl.ActiveTexture(GL_TEXTURE0);
  attach(textures[0], GL_COLOR_ATTACHMENT0, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, colour.data());
  if (has_depth) {
    attach(textures[1], GL_DEPTH_STENCIL_ATTACHMENT, GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL,
           GL_UNSIGNED_INT_24_8, depth.data());
  }
  const GLbitfield depth_bits = has_depth ? GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT : 0;
  gl.BlitFramebuffer(0, 0, extent.width, extent.height, 0, 0, extent.width, extent.height,
                     GL_COLOR_BUFFER_BIT | depth_bits, GL_NEAREST);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  gl.DeleteFramebuffers(1, &framebuffer);
  gl.DeleteTextures(2, textures.data());
}

}  // namespace understudy::spu
