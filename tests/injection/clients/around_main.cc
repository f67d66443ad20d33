// SPDX-License-Identifier: Apache-2.0
// around_main destroyed|current [volume]: uses OpenGL before main, from a constructor, and after it, from an
// atexit handler and a destructor. The context is destroyed at main's end, or still current. Mesa's llvmpipe is
// shut down by then; its softpipe still draws. But Mesa has freed its table of pixel formats and still reads it
// (_mesa_format_from_array_format): after main, pixels are neither sent nor read, and samples are counted
// instead.
#include <string.h>

#include <functional>

#include "image.h"
#include "offscreen.h"

using namespace client;

namespace {

const Offscreen* offscreen = nullptr;
GLuint board = 0;
GLuint ball = 0;
bool current = false;

/// Number of samples that reached the framebuffer while `draw` ran.
GLuint samples_of(const std::function<void()>& draw) {
  GLuint query = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  draw();
  glEndQuery(GL_SAMPLES_PASSED);
  GLuint samples = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &samples);
  glDeleteQueries(1, &query);
  return samples;
}

void after_main(const char* where, int seed) {
  glClear(GL_COLOR_BUFFER_BIT);  // with or without a context
  if (!current) {
    printf("%s: without a context\n", where);
    return;
  }
  const GLuint samples = samples_of([seed] { draw_image(board, seed); });
  printf("%s: %u samples, error %x\n", where, samples, glGetError());
  if (ball != 0) {
    draw_volume(ball, 50);
    glFinish();
    printf("volume: error %x\n", glGetError());
  }
  fflush(stdout);
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
  board = checkerboard(23);
  if (count > 2) {
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
