// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "dispatch/table.h"

namespace understudy::spu {

/// A uniform or a member of a uniform block, as OpenGL lists it.
struct ActiveUniform {
  std::string name;  ///< whole, however long it is; of arrays, that of the first element
  GLenum type = 0;
  GLint elements = 0;
};

inline ActiveUniform active_uniform(const DispatchTable& gl, GLuint program, GLuint index) {
  GLint longest = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORM_MAX_LENGTH, &longest);
  ActiveUniform uniform{std::string(std::size_t(std::max(longest, 1)), '\0')};
  GLsizei length = 0;
  gl.GetActiveUniform(program, index, GLsizei(uniform.name.size()), &length, &uniform.elements, &uniform.type,
                      uniform.name.data());
  uniform.name.resize(std::size_t(length));
  return uniform;
}

}  // namespace understudy::spu
