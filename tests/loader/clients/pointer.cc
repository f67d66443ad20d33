// SPDX-License-Identifier: Apache-2.0
// A library with a global variable named like the function that it will point to, as in some OpenGL loaders.
#include <dlfcn.h>

#define EXPORTED extern "C" __attribute__((visibility("default")))

EXPORTED void (*glClear)(unsigned mask);
void (*glClear)(unsigned mask) = nullptr;

EXPORTED void draw() {
  void* library = dlopen("libGL.so.1", RTLD_NOW);
  glClear = reinterpret_cast<void (*)(unsigned)>(dlsym(library, "glClear"));
  glClear(0x4000);
}
