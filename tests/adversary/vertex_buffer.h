// SPDX-License-Identifier: Apache-2.0
// Positions in a vertex buffer, filled anew before every draw, as attribute 0.
#pragma once

#include <span>

#include "tests/adversary/canvas.h"
#include "tests/adversary/matrix.h"

namespace adversary {

class VertexBuffer {
 public:
  explicit VertexBuffer(const Canvas& canvas) : gl_(canvas.gl) {
    gl_.GenVertexArrays(1, &array_);
    gl_.GenBuffers(1, &buffer_);
  }

  void fill(std::span<const Vector> positions) const {
    gl_.BindVertexArray(array_);
    gl_.BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(positions.size_bytes()), positions.data(),
                   GL_STREAM_DRAW);
    gl_.EnableVertexAttribArray(0);
    gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vector), nullptr);
  }

  void draw(std::span<const Vector> positions, GLenum primitive = GL_TRIANGLES) const {
    fill(positions);
    gl_.DrawArrays(primitive, 0, static_cast<GLsizei>(positions.size()));
  }

 private:
  const Gl& gl_;
  GLuint array_ = 0;
  GLuint buffer_ = 0;
};

}  // namespace adversary
