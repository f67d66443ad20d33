// SPDX-License-Identifier: Apache-2.0
// EGL without a window system: the one place that opens libEGL, its displays, and contexts on them.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <optional>
#include <vector>

#include "volume/offscreen/system_library.h"

namespace understudy::volume::offscreen {

struct EglContextWish {
  std::optional<int> version;  ///< 100 * major + 10 * minor; none: what the driver gives unasked
  bool core = false;
  EGLConfig config = EGL_NO_CONFIG_KHR;  ///< this: for framebuffer objects alone
  EGLContext share = EGL_NO_CONTEXT;
};

/// EGL's functions are called by their own names, without "egl".
class Egl {
 public:
  /// Throws ContextUnavailable where libEGL is missing, or older than EGL 1.5.
  Egl();

  enum class First {
    devices,     ///< they reach a graphics card where there is one
    surfaceless  ///< Mesa's platform
  };

  /// The first display without a window system that takes desktop OpenGL and that `accept` is content with.
  /// It is initialised and never terminated: a display is one for the whole process, and others may use it.
  /// Throws ContextUnavailable, which says that no display gives `what`.
  template <class Accept>
  EGLDisplay open_display(First first, const char* what, Accept accept) const {
    const std::vector<EGLDisplay> found = displays(first);
    for (EGLDisplay display : found) {
      if (Initialize(display, nullptr, nullptr) && BindAPI(EGL_OPENGL_API) && accept(display)) return display;
    }
    none_gives(found.size(), what);
  }

  /// EGL_NO_CONTEXT where the driver has none of this kind.
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
