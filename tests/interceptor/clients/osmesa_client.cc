// SPDX-License-Identifier: Apache-2.0
// An OSMesa program: handles are plain numbers, which the test driver accepts.
#include <GL/gl.h>
#include <GL/osmesa.h>
#include <string.h>

#include "../driver/driver.h"

namespace {

char array[4];

bool current(OSMesaContext context, int width = 2) {
  return OSMesaMakeCurrent(context, array, GL_UNSIGNED_BYTE, width, 2) != 0;
}
void release() {
  OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
}

void frames() {
  OSMesaContext context = OSMesaCreateContext(OSMESA_RGBA, nullptr);
  current(context);
  glClear(0);
  glFlush();
  glFinish();  // the same frame
  glClear(0);
  current(context);  // ends another frame
  current(context, 3);
  release();
  glClear(0);
  OSMesaDestroyContext(context);
}

void share_group() {
  OSMesaContext first = OSMesaCreateContext(OSMESA_RGBA, nullptr);
  OSMesaContext second = OSMesaCreateContext(OSMESA_RGBA, first);
  current(first);
  current(second);
  OSMesaDestroyContext(first);
  glClear(0);
  say("app: glClear %s, glAccum %s\n",
      OSMesaGetProcAddress("glClear") == reinterpret_cast<OSMESAproc>(&glClear) ? "ours" : "not ours",
      OSMesaGetProcAddress("glAccum") == nullptr ? "null" : "not null");
}

/// OSMesa frees a current context at once; the next one gets its address.
void destroyed_while_current() {
  for (int time = 0; time < 2; ++time) {
    OSMesaContext context = OSMesaCreateContext(OSMESA_RGBA, nullptr);
    current(context);
    glClear(0);
    OSMesaDestroyContext(context);
  }
  glClear(0);
}

void buffers() {
  OSMesaContext context = OSMesaCreateContext(OSMESA_RGBA, nullptr);
  current(context);
  GLint width = 0;
  GLint height = 0;
  GLint format = 0;
  void* buffer = nullptr;
  OSMesaGetColorBuffer(context, &width, &height, &format, &buffer);
  OSMesaGetDepthBuffer(context, &width, &height, &format, &buffer);
}

struct Scene {
  const char* name;
  void (*play)();
};
constexpr Scene scenes[] = {{"frames", frames},
                            {"share_group", share_group},
                            {"destroyed_while_current", destroyed_while_current},
                            {"buffers", buffers}};

}  // namespace

int main(int, char** arguments) {
  for (const Scene& scene : scenes) {
    if (strcmp(arguments[1], scene.name) == 0) {
      scene.play();
      return 0;
    }
  }
  return 2;
}
