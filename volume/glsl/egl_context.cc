// SPDX-License-Identifier: Apache-2.0
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "volume/glsl/offscreen_context.h"

namespace understudy::volume::glsl {

namespace {

constexpr EGLint max_devices = 64;

/// EGL 1.5's entry points that are used here.
struct Egl {
  decltype(&eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&eglQueryString) QueryString = nullptr;
  decltype(&eglGetPlatformDisplay) GetPlatformDisplay = nullptr;
  decltype(&eglInitialize) Initialize = nullptr;
  decltype(&eglBindAPI) BindAPI = nullptr;
  decltype(&eglCreateContext) CreateContext = nullptr;
  decltype(&eglDestroyContext) DestroyContext = nullptr;
  decltype(&eglMakeCurrent) MakeCurrent = nullptr;
  decltype(&eglGetError) GetError = nullptr;
};

template <class Pointer>
void find(void* library, const char* name, Pointer& pointer) {
  pointer = reinterpret_cast<Pointer>(dlsym(library, name));
  if (pointer == nullptr)
    throw ContextUnavailable(fmt::format("libEGL.so.1 has no {}: install libegl1 of EGL 1.5 or later", name));
}

Egl open_egl() {
  void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw ContextUnavailable(fmt::format("{}: install libegl1 and libegl-mesa0", dlerror()));
  Egl egl;
  find(library, "eglGetProcAddress", egl.GetProcAddress);
  find(library, "eglQueryString", egl.QueryString);
  find(library, "eglGetPlatformDisplay", egl.GetPlatformDisplay);
  find(library, "eglInitialize", egl.Initialize);
  find(library, "eglBindAPI", egl.BindAPI);
  find(library, "eglCreateContext", egl.CreateContext);
  find(library, "eglDestroyContext", egl.DestroyContext);
  find(library, "eglMakeCurrent", egl.MakeCurrent);
  find(library, "eglGetError", egl.GetError);
  return egl;
}

std::vector<EGLDisplay> candidate_displays(const Egl& egl) {
  std::vector<EGLDisplay> displays;
  const char* extensions = egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto has = [&](std::string_view name) {
    return extensions != nullptr &&
           fmt::format(" {} ", extensions).find(fmt::format(" {} ", name)) != std::string::npos;
  };
  const auto query_devices =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl.GetProcAddress("eglQueryDevicesEXT"));
  std::array<EGLDeviceEXT, max_devices> devices{};
  EGLint count = 0;
  if (has("EGL_EXT_platform_device") && query_devices != nullptr &&
      query_devices(max_devices, devices.data(), &count))
    for (EGLint i = 0; i < count; ++i)
      displays.push_back(egl.GetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[std::size_t(i)], nullptr));
  if (has("EGL_MESA_platform_surfaceless"))
    displays.push_back(egl.GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  std::erase(displays, EGL_NO_DISPLAY);
  return displays;
}

class EglContext final : public OffscreenContext {
 public:
  EglContext() : egl_(open_egl()) {
    const std::vector<EGLDisplay> displays = candidate_displays(egl_);
    for (EGLDisplay display : displays) {
      // Never terminated again: a display is one for the whole process, and others may use it.
      if (!egl_.Initialize(display, nullptr, nullptr) || !egl_.BindAPI(EGL_OPENGL_API)) continue;
      const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   3,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   3,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
      context_ = egl_.CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
      display_ = display;
      if (context_ == EGL_NO_CONTEXT) continue;
      if (egl_.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
        release();
        return;
      }
      egl_.DestroyContext(display, context_);
    }
    throw ContextUnavailable(
        fmt::format("none of {} EGL displays without a window system gives an OpenGL 3.3 core context: install "
                    "libegl-mesa0 and libgl1-mesa-dri, or a driver with EGL_EXT_platform_device",
                    displays.size()));
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  ~EglContext() override { egl_.DestroyContext(display_, context_); }

  void make_current() override {
    // The API that is bound belongs to the thread.
    if (!egl_.BindAPI(EGL_OPENGL_API) || !egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      throw std::runtime_error(fmt::format(
          "the GL backend's EGL context cannot be made current (EGL error {:#x}); --backend cpu does without",
          egl_.GetError()));
  }
  void release() noexcept override {
    egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  Function address(const char* name) const override { return egl_.GetProcAddress(name); }

 private:
  Egl egl_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<OffscreenContext> egl_context() {
  return std::make_unique<EglContext>();
}

}  // namespace understudy::volume::glsl
