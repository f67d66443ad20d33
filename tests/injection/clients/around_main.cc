// SPDX-License-Identifier: Apache-2.0
// around_main destroyed|current [FILE]: OpenGL before main, from a constructor, and after it, from a handler of
// atexit and a destructor; the context is destroyed at main's end, or still current. Mesa's llvmpipe has taken
// itself apart by then; its softpipe draws on.
#include <string.h>

#include "image.h"
#include "offscreen.h"

using namespace client;

namespace {

const Offscreen* offscreen = nullptr;
const char* volume_file = nullptr;
GLuint ball = 0;
bool current = false;

void after_main(const char* where, int seed) {
  glClear(GL_COLOR_BUFFER_BIT);  // with or without a context
  if (!current) {
    printf("%s: without a context\n", where);
    return;
  }
  show(where, seed);
  if (volume_file != nullptr) {
    draw_volume(ball, 50);
    write_file(volume_file, read_pixels());
  }
  offscreen->swap();
}

void at_exit() {
  after_main("atexit", 21);
}

__attribute__((constructor)) void before_main() {
  atexit(at_exit);  // first in, last out
  offscreen = new Offscreen;
  offscreen->make_current();
  show("constructor", 20);
}

__attribute__((destructor)) void at_the_very_end() {
  after_main("destructor", 22);
}

}  // namespace

int main(int count, char** arguments) {
  show("main", 23);
  if (count > 2) {
    volume_file = arguments[2];
    ball = ball_texture();
    draw_volume(ball, 0);
    offscreen->swap();
    draw_volume(ball, 10);
    offscreen->swap();
  }
  current = strcmp(arguments[1], "current") == 0;
  if (!current) {
    offscreen->release();
    offscreen->destroy();
  }
}
