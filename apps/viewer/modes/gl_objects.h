// SPDX-License-Identifier: Apache-2.0
// Owners of OpenGL objects, which they delete on destruction. Destroy them while their context is current.
#pragma once

#include <GL/glew.h>

#include <utility>

namespace viewer {

/// `Delete` is a stateless functor that takes a GLuint.
template <typename Delete>
class GlObject {
 public:
  explicit GlObject(GLuint name = 0) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_ != 0) Delete{}(name_);
  }
  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

struct DeleteTexture {
  void operator()(GLuint name) const { glDeleteTextures(1, &name); }
};
struct DeleteBuffer {
  void operator()(GLuint name) const { glDeleteBuffers(1, &name); }
};
struct DeleteVertexArray {
  void operator()(GLuint name) const { glDeleteVertexArrays(1, &name); }
};
struct DeleteProgram {
  void operator()(GLuint name) const { glDeleteProgram(name); }
};
using Texture = GlObject<DeleteTexture>;
using Buffer = GlObject<DeleteBuffer>;
using VertexArray = GlObject<DeleteVertexArray>;
using Program = GlObject<DeleteProgram>;

inline Texture make_texture() {
  GLuint name = 0;
  glGenTextures(1, &name);
  return Texture(name);
}
inline Buffer make_buffer() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  return Buffer(name);
}
inline VertexArray make_vertex_array() {
  GLuint name = 0;
  glGenVertexArrays(1, &name);
  return VertexArray(name);
}

}  // namespace viewer
