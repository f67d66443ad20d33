// SPDX-License-Identifier: Apache-2.0
// libOSMesa.so.8 of the test driver, with a separate OpenGL.
#include <string.h>

#include "driver.h"

static Handles handles;

DRIVER_FUNCTION long OSMesaCreateContext(unsigned, long share) {
  const long handle = handles.take();
  say("driver: OSMesa create %ld share %ld\n", handle, share);
  return handle;
}
DRIVER_FUNCTION void OSMesaDestroyContext(long handle) {
  handles.give_back(handle);
  say("driver: OSMesa destroy %ld\n", handle);
}
DRIVER_FUNCTION unsigned char OSMesaMakeCurrent(long handle, void*, unsigned, int width, int height) {
  say("driver: OSMesa current %ld of %d x %d\n", handle, width, height);
  return 1;
}
DRIVER_FUNCTION long OSMesaGetCurrentContext() {
  return 0;
}
DRIVER_FUNCTION unsigned char OSMesaGetColorBuffer(long handle, int*, int*, int*, void**) {
  say("driver: OSMesa colours of %ld\n", handle);
  return 1;
}
DRIVER_FUNCTION unsigned char OSMesaGetDepthBuffer(long handle, int*, int*, int*, void**) {
  say("driver: OSMesa depth of %ld\n", handle);
  return 1;
}
DRIVER_FUNCTION void glReadPixels(int, int, int, int, unsigned, unsigned, void*) {
  say("driver: OSMesa's glReadPixels\n");
}
DRIVER_FUNCTION void glClear(unsigned) {
  say("driver: OSMesa's glClear\n");
}
DRIVER_FUNCTION void glFinish() {
  say("driver: OSMesa's glFinish\n");
}
DRIVER_FUNCTION void glFlush() {
  say("driver: OSMesa's glFlush\n");
}
DRIVER_FUNCTION void* OSMesaGetProcAddress(const char* name) {
  if (strcmp(name, "OSMesaCreateContext") == 0) return reinterpret_cast<void*>(&OSMesaCreateContext);
  if (strcmp(name, "glClear") == 0) return reinterpret_cast<void*>(&glClear);
  return nullptr;
}
