#include "spu/player/shown_picture.h"

#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

GLint ask(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

bool is_core(const DispatchTable& gl) {
  const GLint version = ask(gl, GL_MAJOR_VERSION) * 100 + ask(gl, GL_MINOR_VERSION) * 10;
  return version >= 320 && (ask(gl, GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
}

}  // namespace

std::vector<std::uint8_t> shown_picture(const DispatchTable& gl, Extent2D extent) {
  std::vector<std::uint8_t> pixels(std::size_t(4) * std::size_t(extent.width) * std::size_t(extent.height));
  const bool core = is_core(gl);
  const GLint pack_buffer = ask(gl, GL_PIXEL_PACK_BUFFER_BINDING);
  const GLint framebuffer = ask(gl, GL_READ_FRAMEBUFFER_BINDING);
  const PixelStore store = pixel_store(gl, pack_names);
  if (!core) {
    // Scales, biases and maps of the application would colour what is read.
    gl.PushAttrib(GL_PIXEL_MODE_BIT);
    for (const GLenum name : {GL_RED_SCALE, GL_GREEN_SCALE, GL_BLUE_SCALE, GL_ALPHA_SCALE})
      gl.PixelTransferf(name, 1);
    for (const GLenum name : {GL_RED_BIAS, GL_GREEN_BIAS, GL_BLUE_BIAS, GL_ALPHA_BIAS})
      gl.PixelTransferf(name, 0);
    gl.PixelTransferi(GL_MAP_COLOR, 0);
  }
  if (pack_buffer != 0) gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  const GLint read_buffer = ask(gl, GL_READ_BUFFER);
  gl.ReadBuffer(ask(gl, GL_DOUBLEBUFFER) != 0 ? GL_BACK : GL_FRONT);
  set_pixel_store(gl, pack_names, store, tight_pixels);
  gl.ReadPixels(0, 0, extent.width, extent.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  set_pixel_store(gl, pack_names, tight_pixels, store);
  gl.ReadBuffer(GLenum(read_buffer));
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(framebuffer));
  if (pack_buffer != 0) gl.BindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(pack_buffer));
  if (!core) gl.PopAttrib();
  return pixels;
}

}  // namespace understudy::spu
