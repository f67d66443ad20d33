// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/texture_memory.h"

#include <algorithm>
#include <string_view>

namespace understudy::volume::glsl {

namespace {

// From extensions that the Khronos core header does not declare; both are in KiB.
constexpr GLenum current_available_vidmem_nvx = 0x9049;
constexpr GLenum texture_free_memory_ati = 0x87FC;

bool has_extension(const Functions& gl, std::string_view name) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i)
    if (const GLubyte* found = gl.GetStringi(GL_EXTENSIONS, GLuint(i));
        found != nullptr && name == reinterpret_cast<const char*>(found))
      return true;
  return false;
}

}  // namespace

std::optional<std::uint64_t> free_texture_memory(const Functions& gl) {
  std::array<GLint, 4> kib{};  // ATI returns more than the free memory
  if (has_extension(gl, "GL_NVX_gpu_memory_info"))
    gl.GetIntegerv(current_available_vidmem_nvx, kib.data());
  else if (has_extension(gl, "GL_ATI_meminfo"))
    gl.GetIntegerv(texture_free_memory_ati, kib.data());
  if (kib[0] <= 0) return std::nullopt;
  return std::uint64_t(kib[0]) << 10;
}

}  // namespace understudy::volume::glsl
