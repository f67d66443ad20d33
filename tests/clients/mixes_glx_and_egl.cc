// SPDX-License-Identifier: Apache-2.0
// mixes_glx_and_egl: makes a context of GLX and then one of EGL current, and asks both window systems each time
// what they have current. GLX draws into the second of two pbuffers. Exits with status 0 if all answers are
// right.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glx.h>
#include <stdio.h>
#include <stdlib.h>

namespace {

void expect(bool right, const char* what) {
  if (right) return;
  printf("wrong: %s\n", what);
  exit(3);
}

bool glx_has(Display* display, GLXDrawable drawable, GLXContext context) {
  return glXGetCurrentContext() == context && glXGetCurrentDisplay() == display &&
         glXGetCurrentDrawable() == drawable && glXGetCurrentReadDrawable() == drawable;
}
bool glx_has_nothing() {
  return glx_has(nullptr, None, nullptr);
}

bool egl_has(EGLDisplay display, EGLSurface surface, EGLContext context) {
  return eglGetCurrentContext() == context && eglGetCurrentDisplay() == display &&
         eglGetCurrentSurface(EGL_DRAW) == surface && eglGetCurrentSurface(EGL_READ) == surface;
}
bool egl_has_nothing() {
  return egl_has(EGL_NO_DISPLAY, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

/// Returns the display, which GLX no longer has current.
Display* use_glx() {
  Display* const display = XOpenDisplay(nullptr);
  expect(display != nullptr, "XOpenDisplay");
  const int wanted[] = {GLX_DRAWABLE_TYPE, GLX_PBUFFER_BIT, GLX_RENDER_TYPE, GLX_RGBA_BIT, None};
  int count = 0;
  GLXFBConfig* const configs = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
  expect(count > 0, "glXChooseFBConfig");
  const int extent[] = {GLX_PBUFFER_WIDTH, 32, GLX_PBUFFER_HEIGHT, 16, None};
  const GLXPbuffer first = glXCreatePbuffer(display, configs[0], extent);
  const GLXPbuffer second = glXCreatePbuffer(display, configs[0], extent);
  expect(first != None && second != None && first != second, "two pbuffers");
  GLXContext const context = glXCreateNewContext(display, configs[0], GLX_RGBA_TYPE, nullptr, True);
  expect(context != nullptr && glXMakeContextCurrent(display, second, second, context),
         "glXMakeContextCurrent");
  expect(glx_has(display, second, context), "what GLX has, GLX current");
  expect(egl_has_nothing(), "what EGL has, GLX current");
  eglReleaseThread();
  expect(glx_has(display, second, context), "what GLX has after eglReleaseThread");
  glXMakeCurrent(display, None, nullptr);
  expect(glx_has_nothing(), "what GLX has, released");
  return display;
}

void use_egl(Display* x) {
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  expect(eglInitialize(display, nullptr, nullptr), "eglInitialize");
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  expect(eglChooseConfig(display, wanted, &config, 1, &count) && count > 0, "eglChooseConfig");
  const EGLint extent[] = {EGL_WIDTH, 32, EGL_HEIGHT, 16, EGL_NONE};
  EGLSurface surface = eglCreatePbufferSurface(display, config, extent);
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
  expect(eglMakeCurrent(display, surface, surface, context), "eglMakeCurrent");
  expect(egl_has(display, surface, context), "what EGL has, EGL current");
  expect(glx_has_nothing(), "what GLX has, EGL current");
  // As by a library that restores what GLX had current before.
  glXMakeCurrent(x, None, nullptr);
  expect(egl_has(display, surface, context), "what EGL has after glXMakeCurrent");
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  expect(egl_has_nothing(), "what EGL has, released");
}

}  // namespace

int main() {
  use_egl(use_glx());
  puts("all right");
}
