#include "spu/player/shown_picture.h"

#include "spu/player/neutral_pixel_transfer.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

GLint ask(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

}  // namespace

std::vector<std::uint8_t> shown_picture(const DispatchTable& gl, Extent2D extent) {
  return shown_rows(gl, extent.width, 0, extent.height);
}

std::vector<std::uint8_t> shown_rows(const DispatchTable& gl, int width, int first, int count) {
  std::vector<std::uint8_t> pixels(std::size_t(4) * std::size_t(width) * std::size_t(count));
  const GLint pack_buffer = ask(gl, GL_PIXEL_PACK_BUFFER_BINDING);
  const GLint framebuffer = ask(gl, GL_READ_FRAMEBUFFER_BINDING);
  const PixelStore store = pixel_store(gl, pack_names);
  const NeutralPixelTransfer neutral(gl);
  if (pack_buffer != 0) gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  const GLint read_buffer = ask(gl, GL_READ_BUFFER);
  gl.ReadBuffer(ask(gl, GL_DOUBLEBUFFER) != 0 ? GL_BACK : GL_FRONT);
  set_pixel_store(gl, pack_names, store, tight_pixels);
  gl.ReadPixels(0, first, width, count, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  set_pixel_store(gl, pack_names, tight_pixels, store);
  gl.ReadBuffer(GLenum(read_buffer));
  if (framebuffer != 0) gl.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(framebuffer));
  if (pack_buffer != 0) gl.BindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(pack_buffer));
  return pixels;
}

}  // namespace understudy::spu
