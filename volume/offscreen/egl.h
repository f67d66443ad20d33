// SPDX-License-Identifier: Apache-2.0
// EGL without a window system: the only place that opens libEGL, its displays, and contexts on them.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <optional>
#include <vector>

#include "volume/offscreen/system_library.h"

namespace understudy::volume::offscreen {

struct EglContextWish {
  std::optional<int> version;  ///< 100 * major + 10 * minor; empty: the driver's default
  bool core = false;
  EGLConfig config = EGL_NO_CONFIG_KHR;  ///< the default permits rendering to framebuffer objects only
  EGLContext share = EGL_NO_CONTEXT;
};

/// Members have the names of EGL's functions, without "egl".
class Egl {
 public:
  /// Throws ContextUnavailable if libEGL is missing, or older than EGL 1.5.
  Egl();

  enum class First {
    devices,     ///< include graphics cards, if present
    surfaceless  ///< Mesa's platform
  };

  /// Returns the first display without a window system that supports desktop OpenGL and that `accept` accepts.
  /// It is initialised and never terminated: a process has one instance of each display, which others may use.
  /// Throws ContextUnavailable, with the message that no display provides `what`.
  template <class Accept>
  EGLDisplay open_display(First first, const char* what, Accept accept) const {
    const std::vector<EGLDisplay> found = displays(first);
    for (EGLDisplay display : found) {
      if (Initialize(display, nullptr, nullptr) && BindAPI(EGL_OPENGL_API) && accept(display)) return display;
    }
    none_gives(found.size(), what);
  }

  /// EGL_NO_CONTEXT if the driver has none of this kind.
  EGLContext create_context(EGLDisplay display, const EglContextWish& wish) const;

  decltype(&eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&eglQueryString) QueryString = nullptr;
  decltype(&eglGetPlatformDisplay) GetPlatformDisplay = nullptr;
  decltype(&eglInitialize) Initialize = nullptr;
  decltype(&eglBindAPI) BindAPI = nullptr;
  decltype(&eglGetConfigs) GetConfigs = nullptr;
  decltype(&eglGetConfigAttrib) GetConfigAttrib = nullptr;
  decltype(&eglCreateContext) CreateContext = nullptr;
  decltype(&eglDestroyContext) DestroyContext = nullptr;
  decltype(&eglCreatePbufferSurface) CreatePbufferSurface = nullptr;
  decltype(&eglDestroySurface) DestroySurface = nullptr;
  decltype(&eglMakeCurrent) MakeCurrent = nullptr;
  decltype(&eglGetError) GetError = nullptr;

 private:
  /// Not yet initialised.
  std::vector<EGLDisplay> displays(First first) const;
  [[noreturn]] static void none_gives(std::size_t displays, const char* what);
};

}  // namespace understudy::volume::offscreen
