// SPDX-License-Identifier: Apache-2.0
// Draws rectangles into a window's front buffer, or into its back buffer in the middle of a frame; prints
// "drawn" and then waits.
//
//   draws_in_front WAY
#include <GL/gl.h>

#include <cstdio>
#include <string_view>

#include "tests/clients/x_window.h"

namespace {

using client::Buffers;
using client::window_size;
using client::XWindow;

struct Colour {
  float red, green, blue;
};
constexpr Colour red{1, 0, 0};
constexpr Colour green{0, 1, 0};
constexpr Colour blue{0, 0, 1};

void fill(Colour colour, int x, int y, int width, int height) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(x, y, width, height);
  glClearColor(colour.red, colour.green, colour.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

void fill_window(Colour colour) {
  fill(colour, 0, 0, window_size, window_size);
}

void fill_left_half(Colour colour) {
  fill(colour, 0, 0, window_size / 2, window_size);
}

/// Draws a frame and swaps it; the caller draws over it without a swap.
void begin_over_a_frame(const XWindow& window) {
  fill_window(blue);
  window.swap();
}

void one_buffer() {
  const XWindow window(Buffers::one);
  fill_window(blue);
  fill_left_half(green);
  glFlush();
  XWindow::rest();
}

/// More flushes than images that need to be shown.
void many_flushes() {
  const XWindow window(Buffers::one);
  fill_window(blue);
  for (int row = 0; row < window_size; ++row) {
    for (int piece = 0; piece < 32; ++piece) {
      fill(green, piece * 2, row, 2, 1);
      glFlush();
    }
  }
  XWindow::rest();
}

void flushed(bool finished) {
  const XWindow window(Buffers::two);
  begin_over_a_frame(window);
  glDrawBuffer(GL_FRONT);
  fill_left_half(green);
  finished ? glFinish() : glFlush();
  XWindow::rest();
}

void waited_for() {
  const XWindow window(Buffers::two);
  begin_over_a_frame(window);
  glDrawBuffer(GL_FRONT_AND_BACK);
  fill_left_half(green);
  glXWaitGL();
  XWindow::rest();
}

void released() {
  const XWindow window(Buffers::two);
  begin_over_a_frame(window);
  glDrawBuffer(GL_FRONT_LEFT);
  fill_left_half(green);
  window.release();
  XWindow::rest();
}

/// Draws into the back buffer again before the front buffer is flushed.
void drawn_over() {
  const XWindow window(Buffers::two);
  begin_over_a_frame(window);
  glPushAttrib(GL_COLOR_BUFFER_BIT);
  glDrawBuffer(GL_FRONT);
  fill_left_half(green);
  glPopAttrib();
  fill_window(red);
  glFlush();
  XWindow::rest();
}

void by_list() {
  const XWindow window(Buffers::two);
  glNewList(1, GL_COMPILE);
  glDrawBuffer(GL_FRONT);
  glEndList();
  begin_over_a_frame(window);
  glFlush();
  glCallList(1);
  fill_left_half(green);
  glFlush();
  XWindow::rest();
}

/// Five frames with flushes in between, and half of another frame.
void back_buffer() {
  const XWindow window(Buffers::two);
  for (const Colour colour : {red, green, red, green, blue}) {
    fill_left_half(colour);
    glFlush();
    fill_window(colour);
    glFlush();
    glFinish();
    window.swap();
  }
  fill_left_half(red);
  glFlush();
  glFinish();
  glXWaitGL();
  XWindow::rest();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view way = argc == 2 ? argv[1] : "";
  if (way == "one_buffer") one_buffer();
  if (way == "many_flushes") many_flushes();
  if (way == "flushed") flushed(false);
  if (way == "finished") flushed(true);
  if (way == "waited_for") waited_for();
  if (way == "released") released();
  if (way == "drawn_over") drawn_over();
  if (way == "by_list") by_list();
  if (way == "back_buffer") back_buffer();
  std::fprintf(stderr, "draws_in_front: there is no way '%s'\n", argc == 2 ? argv[1] : "");
  return 2;
}
