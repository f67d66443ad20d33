#include "volume/glsl/device.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::volume::glsl {

namespace {

std::string text(const GLubyte* bytes) {
  return bytes == nullptr ? "unknown" : reinterpret_cast<const char*>(bytes);
}

template <class Pointer>
void find(const OffscreenContext& context, const char* name, Pointer& pointer) {
  pointer = reinterpret_cast<Pointer>(context.address(name));
  if (pointer == nullptr)
    throw ContextUnavailable(fmt::format("this OpenGL has no {}: 3.3 core is needed", name));
}

}  // namespace

Device::Device(Platform platform) : context_(platform == Platform::egl ? egl_context() : osmesa_context()) {
  const Current current(*this);
#define UNDERSTUDY_GLSL_FIND(name, type) find(*context_, "gl" #name, gl_.name);
  UNDERSTUDY_GLSL_FUNCTIONS(UNDERSTUDY_GLSL_FIND)
#undef UNDERSTUDY_GLSL_FIND
  description_ = fmt::format("{}, OpenGL {}, on {}", text(gl_.GetString(GL_RENDERER)),
                             text(gl_.GetString(GL_VERSION)), platform == Platform::egl ? "EGL" : "OSMesa");
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_edge_);
  gl_.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_volume_edge_);
  // A core context draws nothing without one; it stays bound, and empty.
  GLuint no_arrays = 0;
  gl_.GenVertexArrays(1, &no_arrays);
  gl_.BindVertexArray(no_arrays);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  check("preparing the context");
}

Device::~Device() = default;

const MarchProgram& Device::program(const MarchVariant& variant) {
  auto found = programs_.find(variant);
  if (found == programs_.end()) found = programs_.emplace(variant, link_march_program(gl_, variant)).first;
  return found->second;
}

void Device::check(const char* what) const {
  const GLenum error = gl_.GetError();
  if (error == GL_NO_ERROR) return;
  // One call may leave several flags; a lost context reports for ever.
  for (int flags = 0; flags < 16 && gl_.GetError() != GL_NO_ERROR;) ++flags;
  throw NotSupported(fmt::format("OpenGL error {:#x} while {}{}", error, what,
                                 error == GL_OUT_OF_MEMORY ? ": out of memory for textures" : ""));
}

}  // namespace understudy::volume::glsl
