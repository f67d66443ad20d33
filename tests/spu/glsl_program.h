// SPDX-License-Identifier: Apache-2.0
// Makes a GLSL program as the tests' applications do.
#pragma once

#include <gtest/gtest.h>

#include "dispatch/table.h"

namespace understudy::spu::testing {

/// Returns a linked program with attribute "corner" at location `corner`. If `vertex` is null, the vertex stage
/// is fixed function.
inline GLuint glsl_program(const DispatchTable& gl, const char* vertex, const char* fragment,
                           GLuint corner = 0) {
  const GLuint name = gl.CreateProgram();
  for (const auto& [stage, source] : {std::pair{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {
    if (source == nullptr) continue;
    const GLuint shader = gl.CreateShader(GLenum(stage));
    gl.ShaderSource(shader, 1, &source, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(name, shader);
    gl.DeleteShader(shader);
  }
  gl.BindAttribLocation(name, corner, "corner");
  gl.LinkProgram(name);
  GLint linked = 0;
  gl.GetProgramiv(name, GL_LINK_STATUS, &linked);
  EXPECT_TRUE(linked) << fragment;
  return name;
}

}  // namespace understudy::spu::testing
