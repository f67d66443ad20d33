// SPDX-License-Identifier: Apache-2.0
// libGLX.so.0 of the test driver.
#include <dlfcn.h>
#include <string.h>

#include "driver.h"

static Handles handles;

DRIVER_FUNCTION long glXCreateContext(void*, void*, long share, int) {
  const long handle = handles.take();
  say("driver: create %ld share %ld\n", handle, share);
  return handle;
}
DRIVER_FUNCTION long glXCreateContextAttribsARB(void*, void*, long share, int, const int*) {
  const long handle = handles.take();
  say("driver: create %ld share %ld\n", handle, share);
  return handle;
}
DRIVER_FUNCTION void glXDestroyContext(void*, long handle) {
  handles.give_back(handle);
  say("driver: destroy %ld\n", handle);
}
DRIVER_FUNCTION int glXMakeCurrent(void*, unsigned long drawable, long handle) {
  const bool done = drawable != bad_drawable;
  say("driver: current %ld drawable %lu%s\n", handle, drawable, done ? "" : " refused");
  return done;
}
DRIVER_FUNCTION int glXMakeContextCurrent(void* display, unsigned long draw, unsigned long, long handle) {
  return glXMakeCurrent(display, draw, handle);
}
DRIVER_FUNCTION void glXSwapBuffers(void*, unsigned long drawable) {
  say("driver: swap %lu\n", drawable);
  // Some drivers call exported OpenGL functions themselves, and get whatever has that name in this process.
  if (auto flush = reinterpret_cast<void (*)()>(dlsym(RTLD_DEFAULT, "glFlush"))) flush();
}
DRIVER_FUNCTION void glXWaitGL() {
  say("driver: wait\n");
}
DRIVER_FUNCTION long glXGetCurrentContext() {
  return 0;
}

static void clear(unsigned) {
  say("driver: glClear\n");
}
static void vendor_function() {
  say("driver: glVendorFunction\n");
}

/// A function that is in no registry: only its caller and the function itself know its parameters.
static int draw_mesh(int a, int b, int c, int d, int e, int f, int g, int h, double p, double q, double r,
                     double s, double t, double u, double v, double w, double x) {
  say("driver: glDrawMeshNV %d %d %d %d %d %d %d %d, %g %g %g %g %g %g %g %g %g\n", a, b, c, d, e, f, g, h, p,
      q, r, s, t, u, v, w, x);
  return 4711;
}

DRIVER_FUNCTION void* glXGetProcAddressARB(const char* name) {
  if (strcmp(name, "glClear") == 0) return reinterpret_cast<void*>(&clear);
  if (strcmp(name, "glVendorFunction") == 0) return reinterpret_cast<void*>(&vendor_function);
  if (strcmp(name, "glDrawMeshNV") == 0) return reinterpret_cast<void*>(&draw_mesh);
  if (strcmp(name, "glXSwapBuffers") == 0) return reinterpret_cast<void*>(&glXSwapBuffers);
  return nullptr;
}
