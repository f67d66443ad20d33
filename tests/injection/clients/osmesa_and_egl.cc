// SPDX-License-Identifier: Apache-2.0
// Alternates contexts of OSMesa and of EGL on one thread: two OpenGL libraries in one program.
#include <GL/osmesa.h>

#include "image.h"
#include "offscreen.h"

using namespace client;

int main() {
  const Offscreen offscreen;
  const OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, nullptr);
  std::vector<unsigned char> array(std::size_t(4) * image_size * image_size);
  for (int i = 0; i < 3; ++i) {
    offscreen.make_current();
    show("EGL", i);
    offscreen.swap();
    offscreen.release();
    if (!OSMesaMakeCurrent(context, array.data(), GL_UNSIGNED_BYTE, image_size, image_size)) return 3;
    show("OSMesa", 10 + i);
    glFinish();
    printf("array: %016lx\n", digest(array));
    OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
  }
  OSMesaDestroyContext(context);
}
