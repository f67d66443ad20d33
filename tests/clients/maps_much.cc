// SPDX-License-Identifier: Apache-2.0
// Maps a buffer of more than one gibibyte, writes a little at its ends and in the middle, and reads it back
// through OpenGL. Exits with status 1 if the data differs.
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <array>
#include <cstddef>

#include "tests/injection/clients/offscreen.h"

namespace {

constexpr GLsizeiptr bytes = (GLsizeiptr(1) << 30) + 4096;
constexpr std::array<GLintptr, 3> places{5, bytes / 2, bytes - 1};

bool comes_back(GLubyte first) {
  bool all = true;
  for (std::size_t i = 0; i < places.size(); ++i) {
    GLubyte there = 0;
    glGetBufferSubData(GL_ARRAY_BUFFER, places[i], 1, &there);
    all = all && there == first + i;
  }
  return all && glGetError() == GL_NO_ERROR;
}

bool write(void* mapped, GLubyte first) {
  if (mapped == nullptr) client::give_up("glMapBuffer");
  for (std::size_t i = 0; i < places.size(); ++i) static_cast<GLubyte*>(mapped)[places[i]] = GLubyte(first + i);
  return glUnmapBuffer(GL_ARRAY_BUFFER) == GL_TRUE;
}

}  // namespace

int main() {
  const client::Offscreen context;
  context.make_current();
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, bytes, nullptr, GL_STATIC_DRAW);
  const GLbitfield writing = GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT;
  if (!write(glMapBufferRange(GL_ARRAY_BUFFER, 0, bytes, writing), 1) || !comes_back(1)) return 1;
  return write(glMapBuffer(GL_ARRAY_BUFFER, GL_READ_WRITE), 11) && comes_back(11) ? 0 : 1;
}
