// SPDX-License-Identifier: Apache-2.0
#include "volume/offscreen/egl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace understudy::volume::offscreen {

namespace {

constexpr EGLint max_devices = 64;

}  // namespace

Egl::Egl() {
  const SystemLibrary library({"libEGL.so.1"}, "libegl1 and libegl-mesa0");
  const auto find = [&](const char* name, auto& function) {
    library.find(name, "libegl1 of EGL 1.5 or later", function);
  };
  find("eglGetProcAddress", GetProcAddress);
  find("eglQueryString", QueryString);
  find("eglGetPlatformDisplay", GetPlatformDisplay);
  find("eglInitialize", Initialize);
  find("eglBindAPI", BindAPI);
  find("eglGetConfigs", GetConfigs);
  find("eglGetConfigAttrib", GetConfigAttrib);
  find("eglCreateContext", CreateContext);
  find("eglDestroyContext", DestroyContext);
  find("eglCreatePbufferSurface", CreatePbufferSurface);
  find("eglDestroySurface", DestroySurface);
  find("eglMakeCurrent", MakeCurrent);
  find("eglGetError", GetError);
}

std::vector<EGLDisplay> Egl::displays(First first) const {
  const char* extensions = QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto has = [&](std::string_view name) {
    return extensions != nullptr &&
           fmt::format(" {} ", extensions).find(fmt::format(" {} ", name)) != std::string::npos;
  };
  std::vector<EGLDisplay> found;
  const auto query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(GetProcAddress("eglQueryDevicesEXT"));
  std::array<EGLDeviceEXT, max_devices> devices{};
  EGLint count = 0;
  if (has("EGL_EXT_platform_device") && query_devices != nullptr &&
      query_devices(max_devices, devices.data(), &count))
    for (EGLint i = 0; i < count; ++i)
      found.push_back(GetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[std::size_t(i)], nullptr));
  if (has("EGL_MESA_platform_surfaceless"))
    found.insert(first == First::surfaceless ? found.begin() : found.end(),
                 GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  std::erase(found, EGL_NO_DISPLAY);
  return found;
}

void Egl::none_gives(std::size_t displays, const char* what) {
  const std::string why =
      displays == 0 ? "EGL has no display without a window system"
                    : fmt::format("EGL gives no {} on {} displays without a window system", what, displays);
  throw ContextUnavailable(
      why + "; install libegl-mesa0 and libgl1-mesa-dri, or a driver with EGL_EXT_platform_device");
}

EGLContext Egl::create_context(EGLDisplay display, const EglContextWish& wish) const {
  std::vector<EGLint> attributes;
  if (wish.version) {
    attributes = {EGL_CONTEXT_MAJOR_VERSION, *wish.version / 100, EGL_CONTEXT_MINOR_VERSION,
                  *wish.version / 10 % 10};
  }
  if (wish.version >= 320) {
    attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         wish.core ? EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT
                                                   : EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT});
  }
  attributes.push_back(EGL_NONE);
  return CreateContext(display, wish.config, wish.share, attributes.data());
}

}  // namespace understudy::volume::offscreen
