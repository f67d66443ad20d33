// SPDX-License-Identifier: Apache-2.0
// Writes text with glyphs of an X server's font, as display lists, including glyphs that the font lacks. Prints
// how far the first one moves the raster position, then "drawn", and waits.
//
//   writes_text FONT FIRST COUNT
#include <GL/gl.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "tests/clients/x_window.h"

namespace {

/// Rows of the font's characters, one after the other.
void write_all(int count) {
  constexpr int columns = 12;
  for (int i = 0; i < count; ++i) {
    // Offset by a quarter of a pixel, so that rounding gives the same result with any driver.
    const int row = i / columns;
    if (i % columns == 0) glRasterPos2f(4.25F, float(client::window_size - 18 * (row + 1)) + 0.25F);
    glCallList(GLuint(1 + i));
  }
}

/// Whether the pixel store has these values; glXUseXFont must not change it.
bool pixel_store_is(GLint alignment, GLint row_length) {
  GLint now_alignment = 0;
  GLint now_row_length = 0;
  glGetIntegerv(GL_UNPACK_ALIGNMENT, &now_alignment);
  glGetIntegerv(GL_UNPACK_ROW_LENGTH, &now_row_length);
  return now_alignment == alignment && now_row_length == row_length;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const client::XWindow window(client::Buffers::two);
  glViewport(0, 0, client::window_size, client::window_size);
  glMatrixMode(GL_PROJECTION);
  glOrtho(0, client::window_size, 0, client::window_size, -1, 1);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 77);
  const int count = std::atoi(argv[3]);
  glXUseXFont(XLoadFont(window.display(), argv[1]), std::atoi(argv[2]), count, 1);
  if (!pixel_store_is(8, 77) || !glIsList(1) || !glIsList(GLuint(count)) || glIsList(GLuint(count) + 1))
    return 4;
  glClearColor(0, 0, 0.5F, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glColor3f(1, 1, 0);
  write_all(count);
  constexpr std::array<GLubyte, 5> again = {1, 3, 5, 7, 9};
  glRasterPos2f(4.25F, 4.25F);
  glListBase(1);
  glCallLists(GLsizei(again.size()), GL_UNSIGNED_BYTE, again.data());
  glRasterPos2f(4.25F, 4.25F);
  glCallList(1);
  std::array<GLfloat, 4> place{};
  glGetFloatv(GL_CURRENT_RASTER_POSITION, place.data());
  std::printf("moves by %.2f\n", place[0] - 4.25F);
  if (glGetError() != GL_NO_ERROR) return 5;
  window.swap();
  client::XWindow::rest();
}
