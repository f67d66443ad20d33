// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/program.h"

#include <fmt/format.h>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

[[noreturn]] void throw_log(const std::string& name, const char* step, const std::string& log) {
  throw Error(ExitCode::no_opengl, fmt::format("the {} program does not {}: {}(the OpenGL driver is too old or "
                                               "broken; --mode rgba needs no shaders)",
                                               name, step, log));
}

GLuint compile(GLenum stage, const std::string& name, const char* source) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw_log(name, "compile", log);
  }
  return shader;
}

}  // namespace

Program link_program(const std::string& name, const char* vertex_source, const char* fragment_source) {
  Program program(glCreateProgram());
  for (const auto& [stage, source] :
       {std::pair{GL_VERTEX_SHADER, vertex_source}, std::pair{GL_FRAGMENT_SHADER, fragment_source}}) {
    const GLuint shader = compile(static_cast<GLenum>(stage), name, source);
    glAttachShader(program.name(), shader);
    glDeleteShader(shader);  // deleted together with the program
  }
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (!linked) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw_log(name, "link", log);
  }
  return program;
}

}  // namespace viewer
