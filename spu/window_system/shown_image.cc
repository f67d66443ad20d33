// SPDX-License-Identifier: Apache-2.0
#include "spu/window_system/shown_image.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "spu/state_value.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

int version_of(const DispatchTable& gl) {
  return state_value(gl, GL_MAJOR_VERSION) * 100 + state_value(gl, GL_MINOR_VERSION) * 10;
}

bool has_core_profile(const DispatchTable& gl) {
  return version_of(gl) >= 320 && (state_value(gl, GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
}

std::size_t pixels_of(Extent2D extent) {
  return std::size_t(extent.width) * std::size_t(extent.height);
}

GLenum window_buffer(const DispatchTable& gl) {
  return state_value(gl, GL_DOUBLEBUFFER) != 0 ? GL_BACK : GL_FRONT;
}

/// While in scope, pixels are transferred unchanged between tightly packed memory and framebuffers.
class PlainPixels {
 public:
  PlainPixels(const DispatchTable& gl, GLenum buffer_target, GLenum buffer_binding,
              const std::array<GLenum, 8>& names)
      : gl_(gl),
        core_(has_core_profile(gl)),
        buffer_target_(buffer_target),
        buffer_(state_value(gl, buffer_binding)),
        names_(names),
        store_(pixel_store(gl, names)) {
    if (!core_) {
      // The application's scales, biases and maps would change the pixels.
      gl.PushAttrib(GL_PIXEL_MODE_BIT);
      for (const GLenum name : {GL_RED_SCALE, GL_GREEN_SCALE, GL_BLUE_SCALE, GL_ALPHA_SCALE, GL_DEPTH_SCALE})
        gl.PixelTransferf(name, 1);
      for (const GLenum name : {GL_RED_BIAS, GL_GREEN_BIAS, GL_BLUE_BIAS, GL_ALPHA_BIAS, GL_DEPTH_BIAS})
        gl.PixelTransferf(name, 0);
      for (const GLenum name : {GL_MAP_COLOR, GL_MAP_STENCIL, GL_INDEX_SHIFT, GL_INDEX_OFFSET})
        gl.PixelTransferi(name, 0);
    }
    if (buffer_ != 0) gl.BindBuffer(buffer_target, 0);
    set_pixel_store(gl, names, store_, tight_pixels);
  }
  ~PlainPixels() {
    set_pixel_store(gl_, names_, tight_pixels, store_);
    if (buffer_ != 0) gl_.BindBuffer(buffer_target_, GLuint(buffer_));
    if (!core_) gl_.PopAttrib();
  }
  PlainPixels(const PlainPixels&) = delete;
  PlainPixels& operator=(const PlainPixels&) = delete;

 private:
  const DispatchTable& gl_;
  const bool core_;
  const GLenum buffer_target_;
  const GLint buffer_;
  const std::array<GLenum, 8>& names_;
  const PixelStore store_;
};

struct Destination {
  GLenum format;
  GLenum type;
  void* pixels;
};

void read_window(const DispatchTable& gl, int width, int first_row, int rows,
                 std::initializer_list<Destination> wanted) {
  const GLint framebuffer = state_value(gl, GL_READ_FRAMEBUFFER_BINDING);
  const PlainPixels plain(gl, GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING, pack_names);
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  const GLint read_buffer = state_value(gl, GL_READ_BUFFER);
  gl.ReadBuffer(window_buffer(gl));
  for (const Destination& one : wanted)
    gl.ReadPixels(0, first_row, width, rows, one.format, one.type, one.pixels);
  gl.ReadBuffer(GLenum(read_buffer));
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(framebuffer));
}

/// Attaches a texture of one level to the framebuffer that is bound for reading.
void attach(const DispatchTable& gl, GLuint texture, GLenum attachment, GLint format, Extent2D extent,
            const Destination& source) {
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, format, extent.width, extent.height, 0, source.format, source.type,
                source.pixels);
  gl.FramebufferTexture2D(GL_READ_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
}

/// The buffers that are bound for drawing.
std::vector<GLenum> draw_buffers(const DispatchTable& gl) {
  std::vector<GLenum> buffers(std::size_t(std::clamp(state_value(gl, GL_MAX_DRAW_BUFFERS), 1, 16)));
  for (std::size_t i = 0; i < buffers.size(); ++i)
    buffers[i] = GLenum(state_value(gl, GLenum(GL_DRAW_BUFFER0) + GLenum(i)));
  while (buffers.size() > 1 && buffers.back() == GL_NONE) buffers.pop_back();
  return buffers;
}

/// While in scope, disables the scissor test of the first viewport. Those of other viewports do not matter
/// here.
class NoScissor {
 public:
  explicit NoScissor(const DispatchTable& gl)
      : gl_(gl), indexed_(version_of(gl) >= 410), enabled_(gl.IsEnabled(GL_SCISSOR_TEST)) {
    if (enabled_) indexed_ ? gl.Disablei(GL_SCISSOR_TEST, 0) : gl.Disable(GL_SCISSOR_TEST);
  }
  ~NoScissor() {
    if (enabled_) indexed_ ? gl_.Enablei(GL_SCISSOR_TEST, 0) : gl_.Enable(GL_SCISSOR_TEST);
  }
  NoScissor(const NoScissor&) = delete;
  NoScissor& operator=(const NoScissor&) = delete;

 private:
  const DispatchTable& gl_;
  const bool indexed_;
  const GLboolean enabled_;
};

}  // namespace

std::vector<std::uint8_t> shown_image(const DispatchTable& gl, Extent2D extent) {
  return shown_rows(gl, extent.width, 0, extent.height);
}

std::vector<std::uint8_t> shown_rows(const DispatchTable& gl, int width, int first, int count) {
  std::vector<std::uint8_t> pixels(4 * pixels_of({width, count}));
  read_window(gl, width, first, count, {{GL_RGBA, GL_UNSIGNED_BYTE, pixels.data()}});
  return pixels;
}

WindowContents cleared_contents(Extent2D extent, bool depth_stencil) {
  return {.extent = extent,
          .colours = std::vector<std::uint8_t>(4 * pixels_of(extent)),
          .depth_stencil = std::vector<std::uint32_t>(depth_stencil ? pixels_of(extent) : 0, far_away)};
}

WindowContents window_contents(const DispatchTable& gl, Extent2D extent, bool depth_stencil) {
  WindowContents contents = cleared_contents(extent, depth_stencil);
  read_window(gl, extent.width, 0, extent.height, {{GL_RGBA, GL_UNSIGNED_BYTE, contents.colours.data()}});
  if (depth_stencil)
    read_window(gl, extent.width, 0, extent.height,
                {{GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, contents.depth_stencil.data()}});
  return contents;
}

void set_window_contents(const DispatchTable& gl, const WindowContents& contents) {
  // A blit depends on less of the context's state than drawing and clearing.
  const PlainPixels plain(gl, GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING, unpack_names);
  const NoScissor no_scissor(gl);
  const GLint drawn_to = state_value(gl, GL_DRAW_FRAMEBUFFER_BINDING),
              read_from = state_value(gl, GL_READ_FRAMEBUFFER_BINDING);
  const GLint bound = state_value(gl, GL_TEXTURE_BINDING_2D);
  GLuint framebuffer = 0;
  std::array<GLuint, 2> textures{};
  gl.GenFramebuffers(1, &framebuffer);
  gl.GenTextures(GLsizei(textures.size()), textures.data());
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const auto [width, height] = contents.extent;
  // The contents are only read.
  void* colours = const_cast<std::uint8_t*>(contents.colours.data());
  attach(gl, textures[0], GL_COLOR_ATTACHMENT0, GL_RGBA8, contents.extent,
         {GL_RGBA, GL_UNSIGNED_BYTE, colours});
  GLbitfield all = GL_COLOR_BUFFER_BIT;
  if (!contents.depth_stencil.empty()) {
    void* depth_stencil = const_cast<std::uint32_t*>(contents.depth_stencil.data());
    attach(gl, textures[1], GL_DEPTH_STENCIL_ATTACHMENT, GL_DEPTH24_STENCIL8, contents.extent,
           {GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, depth_stencil});
    all |= GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT;
  }
  const std::vector<GLenum> buffers = draw_buffers(gl);
  gl.DrawBuffer(window_buffer(gl));
  gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, all, GL_NEAREST);
  if (buffers.size() > 1) {
    gl.DrawBuffers(GLsizei(buffers.size()), buffers.data());
  } else {
    gl.DrawBuffer(buffers.front());
  }
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(read_from));
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(drawn_to));
  gl.BindTexture(GL_TEXTURE_2D, GLuint(bound));
  gl.DeleteFramebuffers(1, &framebuffer);
  gl.DeleteTextures(GLsizei(textures.size()), textures.data());
}

}  // namespace understudy::spu
