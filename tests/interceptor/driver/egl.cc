// SPDX-License-Identifier: Apache-2.0
// libEGL.so.1 of the test driver.
#include <string.h>

#include <initializer_list>

#include "driver.h"

constexpr unsigned opengl_es_api = 0x30A0;
constexpr int context_client_type = 0x3097;

static Handles handles;
static unsigned bound_api = opengl_es_api;
static unsigned api_of[Handles::size];

DRIVER_FUNCTION long eglGetDisplay(void*) {
  say("driver: eglGetDisplay\n");
  return 1;
}
DRIVER_FUNCTION unsigned eglInitialize(void*, int*, int*) {
  return 1;
}
DRIVER_FUNCTION unsigned eglBindAPI(unsigned api) {
  bound_api = api;
  return 1;
}
DRIVER_FUNCTION unsigned eglQueryAPI() {
  return bound_api;
}
DRIVER_FUNCTION long eglCreateContext(void*, void*, long share, const int*) {
  const long handle = handles.take();
  api_of[handle] = bound_api;
  say("driver: create %ld share %ld\n", handle, share);
  return handle;
}
DRIVER_FUNCTION unsigned eglQueryContext(void*, long handle, int attribute, int* value) {
  if (attribute != context_client_type || handle <= 0 || handle >= Handles::size) return 0;
  *value = static_cast<int>(api_of[handle]);
  return 1;
}
DRIVER_FUNCTION unsigned eglDestroyContext(void*, long handle) {
  handles.give_back(handle);
  say("driver: destroy %ld\n", handle);
  return 1;
}
DRIVER_FUNCTION unsigned eglMakeCurrent(void*, long draw, long, long handle) {
  const bool done = draw != static_cast<long>(bad_drawable);
  say("driver: current %ld drawable %ld%s\n", handle, draw, done ? "" : " refused");
  return done;
}
DRIVER_FUNCTION unsigned eglReleaseThread() {
  say("driver: release thread\n");
  return 1;
}
DRIVER_FUNCTION unsigned eglTerminate(void*) {
  say("driver: terminate\n");
  return 1;
}
DRIVER_FUNCTION long eglCreateSync(void*, unsigned, const long*) {
  say("driver: create sync\n");
  return 1;
}
DRIVER_FUNCTION int eglClientWaitSync(void*, long, int, unsigned long) {
  say("driver: client waits\n");
  return 1;
}
DRIVER_FUNCTION unsigned eglWaitSync(void*, long, long) {
  say("driver: server waits\n");
  return 1;
}
DRIVER_FUNCTION long eglCreateImage(void*, long, unsigned, long, const long*) {
  say("driver: create image\n");
  return 1;
}
DRIVER_FUNCTION unsigned eglSwapBuffers(void*, long surface) {
  say("driver: swap %ld\n", surface);
  return 1;
}

static unsigned swap_with_damage(void*, long surface, const int*, int) {
  say("driver: swap %ld with damage\n", surface);
  return 1;
}
static unsigned swap_region(void*, long surface, int, const int*) {
  say("driver: swap region of %ld\n", surface);
  return 1;
}
static unsigned post_sub_buffer(void*, long surface, int, int, int, int) {
  say("driver: post part of %ld\n", surface);
  return 1;
}
static void clear(unsigned) {
  say("driver: glClear\n");
}

DRIVER_FUNCTION void* eglGetProcAddress(const char* name) {
  if (strcmp(name, "glClear") == 0) return reinterpret_cast<void*>(&clear);
  if (strcmp(name, "eglSwapBuffersWithDamageKHR") == 0) return reinterpret_cast<void*>(&swap_with_damage);
  for (const char* region : {"eglSwapBuffersRegionNOK", "eglSwapBuffersRegion2NOK"})
    if (strcmp(name, region) == 0) return reinterpret_cast<void*>(&swap_region);
  if (strcmp(name, "eglPostSubBufferNV") == 0) return reinterpret_cast<void*>(&post_sub_buffer);
  // The extensions' parameters have other types, whose values this driver does not read.
  for (const char* create : {"eglCreateSyncKHR", "eglCreateSync64KHR"})
    if (strcmp(name, create) == 0) return reinterpret_cast<void*>(&eglCreateSync);
  if (strcmp(name, "eglClientWaitSyncKHR") == 0) return reinterpret_cast<void*>(&eglClientWaitSync);
  if (strcmp(name, "eglWaitSyncKHR") == 0) return reinterpret_cast<void*>(&eglWaitSync);
  if (strcmp(name, "eglCreateImageKHR") == 0) return reinterpret_cast<void*>(&eglCreateImage);
  return nullptr;
}
