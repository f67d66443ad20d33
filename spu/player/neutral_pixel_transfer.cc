#include "spu/player/neutral_pixel_transfer.h"

#include <initializer_list>

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

NeutralPixelTransfer::NeutralPixelTransfer(const DispatchTable& gl) : gl_(gl), core_(is_core(gl)) {
  if (core_) return;
  gl_.PushAttrib(GL_PIXEL_MODE_BIT);
  for (const GLenum name : {GL_RED_SCALE, GL_GREEN_SCALE, GL_BLUE_SCALE, GL_ALPHA_SCALE, GL_DEPTH_SCALE})
    gl_.PixelTransferf(name, 1);
  for (const GLenum name : {GL_RED_BIAS, GL_GREEN_BIAS, GL_BLUE_BIAS, GL_ALPHA_BIAS, GL_DEPTH_BIAS})
    gl_.PixelTransferf(name, 0);
  for (const GLenum name : {GL_MAP_COLOR, GL_MAP_STENCIL, GL_INDEX_SHIFT, GL_INDEX_OFFSET})
    gl_.PixelTransferi(name, 0);
}

NeutralPixelTransfer::~NeutralPixelTransfer() {
  if (!core_) gl_.PopAttrib();
}

}  // namespace understudy::spu
