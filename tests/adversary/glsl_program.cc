// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/glsl_program.h"

#include <stdexcept>

namespace adversary {

GLuint compile(const Gl& gl, const ShaderText& shader) {
  const GLuint name = gl.CreateShader(shader.stage);
  const char* text = shader.text.c_str();
  gl.ShaderSource(name, 1, &text, nullptr);
  gl.CompileShader(name);
  GLint compiled = 0;
  gl.GetShaderiv(name, GL_COMPILE_STATUS, &compiled);
  if (compiled != GL_FALSE) return name;
  std::string words(4096, '\0');
  gl.GetShaderInfoLog(name, static_cast<GLsizei>(words.size()), nullptr, words.data());
  throw std::runtime_error("shader does not compile: " + std::string(words.c_str()) + "\n" + shader.text);
}

GlslProgram::GlslProgram(const Canvas& canvas, const std::vector<ShaderText>& shaders)
    : gl_(canvas.gl), name_(canvas.gl.CreateProgram()) {
  link(shaders);
}

void GlslProgram::bind_outputs(const std::vector<std::string>& names) const {
  for (GLuint i = 0; i < names.size(); ++i) gl_.BindFragDataLocation(name_, i, names[i].c_str());
}

void GlslProgram::link(const std::vector<ShaderText>& shaders, const std::vector<std::string>& captured) {
  std::vector<GLuint> names;
  for (const ShaderText& shader : shaders) {
    names.push_back(compile(gl_, shader));
    gl_.AttachShader(name_, names.back());
  }
  std::vector<const char*> varyings;
  for (const std::string& varying : captured) varyings.push_back(varying.c_str());
  if (!varyings.empty())
    gl_.TransformFeedbackVaryings(name_, static_cast<GLsizei>(varyings.size()), varyings.data(),
                                  GL_INTERLEAVED_ATTRIBS);
  gl_.BindAttribLocation(name_, 0, "position");
  gl_.BindAttribLocation(name_, 1, "coordinate");
  gl_.LinkProgram(name_);
  for (const GLuint shader : names) gl_.DetachShader(name_, shader), gl_.DeleteShader(shader);
  GLint linked = 0;
  gl_.GetProgramiv(name_, GL_LINK_STATUS, &linked);
  if (linked != GL_FALSE) return;
  std::string words(4096, '\0');
  gl_.GetProgramInfoLog(name_, static_cast<GLsizei>(words.size()), nullptr, words.data());
  throw std::runtime_error("program does not link: " + std::string(words.c_str()));
}

}  // namespace adversary
