// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/device.h"

#include <fmt/format.h>

#include <algorithm>

#include "volume/glsl/brick_size.h"

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

std::uint64_t automatic_memory(const Functions& gl, int sharers) {
  const std::optional<std::uint64_t> free = free_texture_memory(gl);
  if (!free) return default_texture_memory;
  return std::max(*free / 2 / std::uint64_t(std::max(sharers, 1)), least_texture_memory);
}

}  // namespace

Device::Device(Platform platform, const TextureMemoryWish& memory)
    : context_(platform == Platform::egl ? egl_context() : osmesa_context()) {
  const Current current(*this);
#define UNDERSTUDY_GLSL_FIND(name, type) find(*context_, "gl" #name, gl_.name);
  UNDERSTUDY_GLSL_FUNCTIONS(UNDERSTUDY_GLSL_FIND)
#undef UNDERSTUDY_GLSL_FIND
  description_ = fmt::format("{}, OpenGL {}, on {}", text(gl_.GetString(GL_RENDERER)),
                             text(gl_.GetString(GL_VERSION)), platform == Platform::egl ? "EGL" : "OSMesa");
  gl_.GetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_edge_);
  gl_.GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &max_volume_edge_);
  texture_memory_.emplace(memory.bytes ? *memory.bytes : automatic_memory(gl_, memory.sharers));
  // A core context cannot draw without a vertex array object; this one stays bound, and empty.
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
  // One call may set several error flags; a lost context reports errors for ever.
  for (int flags = 0; flags < 16 && gl_.GetError() != GL_NO_ERROR;) ++flags;
  const std::string text = fmt::format("OpenGL error {:#x} while {}", error, what);
  if (error == GL_OUT_OF_MEMORY) throw OutOfMemory(text + ": out of memory for textures");
  throw NotSupported(text);
}

}  // namespace understudy::volume::glsl
