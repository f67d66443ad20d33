// SPDX-License-Identifier: Apache-2.0
// An EGL program that needs no display: handles are plain numbers, which the test driver accepts.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <stdio.h>
#include <string.h>

#include "../driver/driver.h"

namespace {

EGLDisplay display;
const auto surface = reinterpret_cast<EGLSurface>(20);

EGLContext create(EGLenum api, EGLContext share = EGL_NO_CONTEXT) {
  eglBindAPI(api);
  return eglCreateContext(display, nullptr, share, nullptr);
}
bool current(EGLContext context, EGLSurface draw) {
  return eglMakeCurrent(display, draw, draw, context) == EGL_TRUE;
}

template <class Function>
Function function(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

void one_frame() {
  EGLContext context = create(EGL_OPENGL_API);
  current(context, surface);
  glClear(0);
  eglSwapBuffers(display, surface);
  function<PFNEGLSWAPBUFFERSWITHDAMAGEKHRPROC>("eglSwapBuffersWithDamageKHR")(display, surface, nullptr, 0);
  if (current(context, reinterpret_cast<EGLSurface>(bad_drawable))) say("app: should have failed\n");
  glClear(0);
  eglReleaseThread();
  eglDestroyContext(display, context);
}

/// Fences and images, by EGL 1.5 and by its extensions.
void published() {
  EGLContext context = create(EGL_OPENGL_API);
  current(context, surface);
  EGLSync sync = eglCreateSync(display, EGL_SYNC_FENCE, nullptr);
  eglClientWaitSync(display, sync, 0, 0);
  eglWaitSync(display, sync, 0);
  eglCreateImage(display, context, EGL_GL_TEXTURE_2D, nullptr, nullptr);
  function<PFNEGLCREATESYNCKHRPROC>("eglCreateSyncKHR")(display, EGL_SYNC_FENCE_KHR, nullptr);
  function<PFNEGLCREATESYNC64KHRPROC>("eglCreateSync64KHR")(display, EGL_SYNC_FENCE_KHR, nullptr);
  function<PFNEGLCLIENTWAITSYNCKHRPROC>("eglClientWaitSyncKHR")(display, sync, 0, 0);
  function<PFNEGLWAITSYNCKHRPROC>("eglWaitSyncKHR")(display, sync, 0);
  function<PFNEGLCREATEIMAGEKHRPROC>("eglCreateImageKHR")(display, context, EGL_GL_TEXTURE_2D, nullptr,
                                                          nullptr);
}

void swapped_in_part() {
  current(create(EGL_OPENGL_API), surface);
  function<PFNEGLSWAPBUFFERSREGIONNOKPROC>("eglSwapBuffersRegionNOK")(display, surface, 0, nullptr);
  function<PFNEGLSWAPBUFFERSREGION2NOKPROC>("eglSwapBuffersRegion2NOK")(display, surface, 0, nullptr);
  function<PFNEGLPOSTSUBBUFFERNVPROC>("eglPostSubBufferNV")(display, surface, 0, 0, 1, 1);
}

void opengl_es() {
  EGLContext context = create(EGL_OPENGL_ES_API);
  current(context, surface);
  glClear(0);
  eglSwapBuffers(display, surface);
}

void terminated() {
  EGLContext first = create(EGL_OPENGL_API);
  create(EGL_OPENGL_API, first);
  current(first, surface);
  current(EGL_NO_CONTEXT, EGL_NO_SURFACE);
  eglTerminate(display);
}

void libraries() {
  current(create(EGL_OPENGL_API), surface);
  FILE* maps = fopen("/proc/self/maps", "r");
  bool glx = false;
  bool egl = false;
  char line[4096];
  while (maps != nullptr && fgets(line, sizeof line, maps) != nullptr) {
    glx |= strstr(line, "/driver/libGLX.so.0") != nullptr;
    egl |= strstr(line, "/driver/libEGL.so.1") != nullptr;
  }
  say("app: driver's GLX %s, EGL %s\n", glx ? "loaded" : "not loaded", egl ? "loaded" : "not loaded");
}

struct Scene {
  const char* name;
  void (*play)();
};
constexpr Scene scenes[] = {
    {"one_frame", one_frame}, {"published", published},   {"swapped_in_part", swapped_in_part},
    {"opengl_es", opengl_es}, {"terminated", terminated}, {"libraries", libraries}};

}  // namespace

int main(int, char** arguments) {
  display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  for (const Scene& scene : scenes) {
    if (strcmp(arguments[1], scene.name) == 0) {
      scene.play();
      return 0;
    }
  }
  return 2;
}
