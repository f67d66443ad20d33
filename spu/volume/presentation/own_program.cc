// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/own_program.h"

#include <string>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

GLuint compile(const GlContext& context, GLenum stage, const char* source) {
  const DispatchTable& gl = *context.gl;
  const std::string text = std::string(context.core ? "#version 150\n" : "#version 130\n") + source;
  const char* pointer = text.c_str();
  const GLuint shader = gl.CreateShader(stage);
  gl.ShaderSource(shader, 1, &pointer, nullptr);
  gl.CompileShader(shader);
  return shader;
}

}  // namespace

GLuint link_program(const GlContext& context, const char* vertex_source, const char* fragment_source) {
  const DispatchTable& gl = *context.gl;
  const GLuint vertex = compile(context, GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(context, GL_FRAGMENT_SHADER, fragment_source);
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, vertex);
  gl.AttachShader(program, fragment);
  gl.DeleteShader(vertex);
  gl.DeleteShader(fragment);
  gl.BindAttribLocation(program, 0, "position");
  gl.LinkProgram(program);
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked) return program;
  gl.DeleteProgram(program);
  return 0;
}

}  // namespace understudy::spu
