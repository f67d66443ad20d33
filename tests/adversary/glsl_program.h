// SPDX-License-Identifier: Apache-2.0
// Programs in GLSL, with uniforms by name.
#pragma once

#include <string>
#include <vector>

#include "tests/adversary/canvas.h"
#include "tests/adversary/matrix.h"

namespace adversary {

struct ShaderText {
  GLenum stage;
  std::string text;
};

class GlslProgram {
 public:
  /// Attribute 0 is "position", attribute 1 "coordinate". Throws std::runtime_error with the compiler's words.
  GlslProgram(const Canvas& canvas, const std::vector<ShaderText>& shaders);
  GlslProgram(const Canvas& canvas, const std::string& vertex, const std::string& fragment)
      : GlslProgram(canvas, {{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {}

  GLuint name() const { return name_; }
  void use() const { gl_.UseProgram(name_); }
  GLint location(const std::string& uniform) const { return gl_.GetUniformLocation(name_, uniform.c_str()); }
  /// The program must be in use. A uniform that the program lacks is passed over, as OpenGL does.
  void set(const std::string& uniform, float value) const { gl_.Uniform1f(location(uniform), value); }
  void set(const std::string& uniform, int value) const { gl_.Uniform1i(location(uniform), value); }
  void set(const std::string& uniform, Vector value) const {
    gl_.Uniform3f(location(uniform), value.x, value.y, value.z);
  }
  void set(const std::string& uniform, const Matrix& value) const {
    gl_.UniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data());
  }
  /// For the next link: the n-th name is the fragment shader's n-th output.
  void bind_outputs(const std::vector<std::string>& names) const;
  /// Other shaders under the same name, as a viewer that regenerates its shader.
  void link(const std::vector<ShaderText>& shaders, const std::vector<std::string>& captured = {});

 private:
  const Gl& gl_;
  GLuint name_;
};

/// Compiles; throws std::runtime_error with the compiler's words and the text.
GLuint compile(const Gl& gl, const ShaderText& shader);

}  // namespace adversary
