// SPDX-License-Identifier: Apache-2.0
// osmesa FILE: draws images and then a volume through OSMesa, with which it is linked. Writes the last image of
// the volume to FILE; with a second argument `depth` it also prints the depth buffer's bytes, and with
// `depth_of_second` it draws every image twice before it finishes it.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <string.h>

#include "image.h"

using namespace client;

static std::vector<unsigned char> array(std::size_t(4) * image_size * image_size);

static void current(OSMesaContext context) {
  if (!OSMesaMakeCurrent(context, array.data(), GL_UNSIGNED_BYTE, image_size, image_size))
    puts("OSMesaMakeCurrent fails");
}

static void show_array(const char* name) {
  printf("%s: %016lx error %x\n", name, digest(array), glGetError());
}

/// A framebuffer that could not be read makes no difference to the array's address.
static void ask_for_array(OSMesaContext context) {
  GLuint incomplete = 0;
  glGenFramebuffers(1, &incomplete);
  glBindFramebuffer(GL_FRAMEBUFFER, incomplete);
  GLint width = 0, height = 0, format = 0;
  void* address = nullptr;
  OSMesaGetColorBuffer(context, &width, &height, &format, &address);
  printf("%dx%d, ours %d, error %x\n", width, height, address == array.data(), glGetError());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

int main(int count, char** arguments) {
  const OSMesaContext first = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, nullptr);
  const int attributes[] = {OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 24, 0};
  const OSMesaContext second = OSMesaCreateContextAttribs(attributes, first);
  if (first == nullptr || second == nullptr) return 3;
  current(first);
  printf("%s\n", glGetString(GL_VERSION));
  GLint value = 0;
  OSMesaGetIntegerv(OSMESA_WIDTH, &value);
  printf("width %d, current %d\n", value, OSMesaGetCurrentContext() == first);

  const GLuint texture = checkerboard(5);
  draw_image(texture, 5);
  glFinish();
  show_array("first");
  current(second);
  draw_image(texture, 6);  // shared
  glFlush();
  show_array("second, shared texture");
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  draw_image(texture, 7);
  glFinish();
  show_array("upside down");
  OSMesaPixelStore(OSMESA_Y_UP, 1);
  current(first);
  draw_image(texture, 8);
  OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
  printf("released: %016lx, current %d\n", digest(array), OSMesaGetCurrentContext() == nullptr);
  glClear(GL_COLOR_BUFFER_BIT);  // without a context
  OSMesaDestroyContext(second);
  current(first);
  show("read back", 9);
  ask_for_array(first);
  if (count < 2) return 0;

  const GLuint ball = ball_texture();
  const bool with_depth = count > 2;
  const bool twice = with_depth && strcmp(arguments[2], "depth_of_second") == 0;
  for (int frame = 0; frame < 4; ++frame) {
    if (with_depth) {
      glEnable(GL_DEPTH_TEST);
      glDepthFunc(GL_LEQUAL);
    }
    if (twice) draw_volume(ball, 45);
    draw_volume(ball, 10 * frame);
    glFlush();
    glFinish();
    if (!with_depth) continue;
    GLint width = 0, height = 0, bytes = 0;
    void* depth = nullptr;
    if (!OSMesaGetDepthBuffer(first, &width, &height, &bytes, &depth)) return 4;
    const auto* start = static_cast<const unsigned char*>(depth);
    printf("depth %d: %dx%dx%d %016lx\n", frame, width, height, bytes,
           digest({start, start + std::size_t(width) * std::size_t(height) * std::size_t(bytes)}));
  }
  write_file(arguments[1], array);
  OSMesaDestroyContext(first);
}
