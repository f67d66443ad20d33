// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/window.h"

#include <EGL/eglext.h>

#include <array>
#include <stdexcept>
#include <string>

namespace adversary {
namespace {

void require(bool done, const std::string& what) {
  if (!done) throw std::runtime_error(what + " failed with EGL error " + std::to_string(eglGetError()));
}

EGLDisplay open_display() {
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  EGLDisplay display = EGL_NO_DISPLAY;
  if (platform_display != nullptr)
    display = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  require(display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr), "eglInitialize");
  return display;
}

EGLConfig choose_config(EGLDisplay display) {
  constexpr std::array<EGLint, 17> wanted{EGL_SURFACE_TYPE,
                                          EGL_PBUFFER_BIT,
                                          EGL_RENDERABLE_TYPE,
                                          EGL_OPENGL_BIT,
                                          EGL_RED_SIZE,
                                          8,
                                          EGL_GREEN_SIZE,
                                          8,
                                          EGL_BLUE_SIZE,
                                          8,
                                          EGL_ALPHA_SIZE,
                                          8,
                                          EGL_DEPTH_SIZE,
                                          24,
                                          EGL_STENCIL_SIZE,
                                          8,
                                          EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  require(eglChooseConfig(display, wanted.data(), &config, 1, &count) && count == 1, "eglChooseConfig");
  return config;
}

EGLContext create_context(EGLDisplay display, EGLConfig config, Profile profile) {
  const EGLint bit = profile == Profile::core ? EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT
                                              : EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT;
  const std::array<EGLint, 7> wanted{EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     bit,
                                     EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
  require(context != EGL_NO_CONTEXT, "eglCreateContext");
  return context;
}

}  // namespace

Window::Window(Profile profile, int width, int height) : display_(open_display()) {
  require(eglBindAPI(EGL_OPENGL_API), "eglBindAPI");
  config_ = choose_config(display_);
  context_ = create_context(display_, config_, profile);
  resize(width, height);
}

Window::~Window() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroySurface(display_, surface_);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

void Window::resize(int width, int height) {
  const std::array<EGLint, 5> size{EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
  const EGLSurface before = surface_;
  surface_ = eglCreatePbufferSurface(display_, config_, size.data());
  require(surface_ != EGL_NO_SURFACE, "eglCreatePbufferSurface");
  require(eglMakeCurrent(display_, surface_, surface_, context_), "eglMakeCurrent");
  if (before != EGL_NO_SURFACE) eglDestroySurface(display_, before);
}

void Window::swap() {
  require(eglSwapBuffers(display_, surface_), "eglSwapBuffers");
}

}  // namespace adversary
