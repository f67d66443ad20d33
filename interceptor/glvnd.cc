// SPDX-License-Identifier: Apache-2.0
// What glvnd's libGL.so.1 requires of libGLX.so.0 besides GLX itself. An application that opens the real
// libGL.so.1 by its absolute path, past the folder, gets our libGLX.so.0 as that library's dependency, which
// must export these two symbols. The functions are in glvnd's order (its src/GLX/libglxgl.h); a test compares
// them with the installed library.
#include <GL/glx.h>

#include <cstddef>

#include "interceptor/entry_point.h"
#include "interceptor/real_driver.h"

using AnyFunction = void (*)();

// clang-format off
#define UNDERSTUDY_CORE_GLX(X) \
  X(glXChooseFBConfig) \
  X(glXChooseVisual) \
  X(glXCopyContext) \
  X(glXCreateContext) \
  X(glXCreateGLXPixmap) \
  X(glXCreateNewContext) \
  X(glXCreatePbuffer) \
  X(glXCreatePixmap) \
  X(glXCreateWindow) \
  X(glXDestroyContext) \
  X(glXDestroyGLXPixmap) \
  X(glXDestroyPbuffer) \
  X(glXDestroyPixmap) \
  X(glXDestroyWindow) \
  X(glXGetClientString) \
  X(glXGetConfig) \
  X(glXGetCurrentContext) \
  X(glXGetCurrentDrawable) \
  X(glXGetCurrentReadDrawable) \
  X(glXGetFBConfigAttrib) \
  X(glXGetFBConfigs) \
  X(glXGetProcAddress) \
  X(glXGetProcAddressARB) \
  X(glXGetSelectedEvent) \
  X(glXGetVisualFromFBConfig) \
  X(glXIsDirect) \
  X(glXMakeContextCurrent) \
  X(glXMakeCurrent) \
  X(glXQueryContext) \
  X(glXQueryDrawable) \
  X(glXQueryExtension) \
  X(glXQueryExtensionsString) \
  X(glXQueryServerString) \
  X(glXQueryVersion) \
  X(glXSelectEvent) \
  X(glXSwapBuffers) \
  X(glXUseXFont) \
  X(glXWaitGL) \
  X(glXWaitX)
// clang-format on

extern "C" {
#define UNDERSTUDY_POINTER(name) reinterpret_cast<AnyFunction>(&name),
__attribute__((visibility("default"))) extern const AnyFunction __GLXGL_CORE_FUNCTIONS[];
const AnyFunction __GLXGL_CORE_FUNCTIONS[] = {UNDERSTUDY_CORE_GLX(UNDERSTUDY_POINTER)};
#undef UNDERSTUDY_POINTER
}

/// Stores the function of that name in `*cache` and returns it. glvnd's libGL passes a lock for `*cache`, which
/// is not needed: writing a pointer is atomic, and every thread writes the same value.
UNDERSTUDY_ENTRY AnyFunction __glXGLLoadGLXFunction(const char* name, AnyFunction* cache, void* /*mutex*/) {
  using namespace understudy::interceptor;
  if (*cache == nullptr) {
    void* own = real_symbol(WindowSystem::glx, name) != nullptr ? own_entry(name) : nullptr;
    *cache = reinterpret_cast<AnyFunction>(own);
  }
  return *cache;
}
