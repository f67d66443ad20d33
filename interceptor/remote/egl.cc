// SPDX-License-Identifier: Apache-2.0
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <X11/Xlib.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include <atomic>
#include <cstdint>

#include "interceptor/remote/configs.h"
#include "interceptor/remote/context.h"
#include "interceptor/remote/egl_config.h"
#include "interceptor/remote/named_function.h"
#include "interceptor/remote/x_server.h"

namespace understudy::interceptor {
namespace {

constexpr const char* display_extensions =
    "EGL_KHR_create_context EGL_KHR_get_all_proc_addresses EGL_KHR_surfaceless_context "
    "EGL_KHR_no_config_context";
constexpr const char* client_extensions =
    "EGL_EXT_client_extensions EGL_EXT_platform_base EGL_EXT_platform_x11 EGL_KHR_platform_x11 "
    "EGL_MESA_platform_surfaceless EGL_KHR_client_get_all_proc_addresses";

/// An EGLDisplay.
struct EglDisplay {
  Display* x;  ///< null: no windows
  bool initialized;
  EglDisplay* next;
};

/// An EGLSurface.
struct Surface {
  XID window;  ///< 0: a pbuffer
  int width;
  int height;
  int config;
  int uses;  ///< one by the application, until it destroys the surface, and one wherever it is current
};

constinit pthread_mutex_t egl_lock = PTHREAD_MUTEX_INITIALIZER;
constinit EglDisplay* displays = nullptr;

struct EglThread {
  EGLint error = EGL_SUCCESS;
  EGLenum api = EGL_OPENGL_ES_API;
};

constinit thread_local EglThread egl_thread;

template <class Result>
Result failed(EGLint error, Result result) {
  egl_thread.error = error;
  return result;
}

EGLBoolean done() {
  egl_thread.error = EGL_SUCCESS;
  return EGL_TRUE;
}

EglDisplay* display_of(EGLDisplay display) {
  return static_cast<EglDisplay*>(display);
}

Surface* surface_of(EGLSurface surface) {
  return static_cast<Surface*>(surface);
}

void acquire(std::uintptr_t surface) {
  if (surface != 0) std::atomic_ref(reinterpret_cast<Surface*>(surface)->uses) += 1;
}

void release(std::uintptr_t surface) {
  auto* const of = reinterpret_cast<Surface*>(surface);
  if (of != nullptr && --std::atomic_ref(of->uses) == 0) free(of);
}

struct CurrentSurfaces {
  std::uintptr_t draw = 0;
  std::uintptr_t read = 0;
};

CurrentSurfaces current_surfaces() {
  const RemoteThread thread = remote_thread(WindowSystem::egl);
  return {thread.draw, thread.read};
}

void leave_surfaces() {
  const CurrentSurfaces earlier = current_surfaces();
  leave_remote_context(WindowSystem::egl);
  release(earlier.draw);
  release(earlier.read);
}

const RemoteConfig* config_of(EGLConfig config) {
  return static_cast<const RemoteConfig*>(config);
}

const RemoteConfig* configs_of(const EglDisplay& display, int* count) {
  return remote_configs(display.x, display.x != nullptr ? DefaultScreen(display.x) : 0, count);
}

EGLDisplay find_display(Display* x) {
  pthread_mutex_lock(&egl_lock);
  EglDisplay* found = displays;
  while (found != nullptr && found->x != x) found = found->next;
  if (found == nullptr) {
    found = static_cast<EglDisplay*>(calloc(1, sizeof(EglDisplay)));
    if (found != nullptr) {
      found->x = x;
      found->next = displays;
      displays = found;
    }
  }
  pthread_mutex_unlock(&egl_lock);
  return found;
}

EGLDisplay GetDisplay(EGLNativeDisplayType native) {
  if (native != EGL_DEFAULT_DISPLAY) return find_display(reinterpret_cast<Display*>(native));
  return find_display(default_display());
}

EGLDisplay get_platform_display(EGLenum platform, void* native) {
  switch (platform) {
    case EGL_PLATFORM_X11_KHR:
      return find_display(native != nullptr ? static_cast<Display*>(native) : default_display());
    case EGL_PLATFORM_SURFACELESS_MESA:
    case EGL_PLATFORM_DEVICE_EXT:
      return find_display(nullptr);
    default:
      return failed(EGL_BAD_PARAMETER, EGL_NO_DISPLAY);
  }
}

EGLDisplay GetPlatformDisplay(EGLenum platform, void* native, const EGLAttrib*) {
  return get_platform_display(platform, native);
}

EGLDisplay GetPlatformDisplayEXT(EGLenum platform, void* native, const EGLint*) {
  return get_platform_display(platform, native);
}

EGLBoolean Initialize(EGLDisplay display, EGLint* major, EGLint* minor) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  display_of(display)->initialized = true;
  if (major != nullptr) *major = 1;
  if (minor != nullptr) *minor = 5;
  return done();
}

EGLBoolean Terminate(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  display_of(display)->initialized = false;
  return done();
}

const char* QueryString(EGLDisplay display, EGLint name) {
  egl_thread.error = EGL_SUCCESS;
  if (display == EGL_NO_DISPLAY && name == EGL_EXTENSIONS) return client_extensions;
  switch (name) {
    case EGL_CLIENT_APIS:
      return "OpenGL";
    case EGL_VENDOR:
      return "Understudy";
    case EGL_VERSION:
      return "1.5";
    case EGL_EXTENSIONS:
      return display_extensions;
    default:
      return failed(EGL_BAD_PARAMETER, static_cast<const char*>(nullptr));
  }
}

EGLBoolean ChooseConfig(EGLDisplay display, const EGLint* attributes, EGLConfig* configs, EGLint room,
                        EGLint* count) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  if (count == nullptr) return failed(EGL_BAD_PARAMETER, EGL_FALSE);
  int offered = 0;
  const RemoteConfig* all = configs_of(*display_of(display), &offered);
  *count = 0;
  for (int i = 0; i < offered && (configs == nullptr || *count < room); ++i) {
    // Single-buffered configurations would allow only pbuffers.
    if (all[i].double_buffered == 0 || !meets_egl(all[i], attributes)) continue;
    if (configs != nullptr) configs[*count] = const_cast<RemoteConfig*>(&all[i]);
    ++*count;
  }
  return done();
}

EGLBoolean GetConfigs(EGLDisplay display, EGLConfig* configs, EGLint room, EGLint* count) {
  return ChooseConfig(display, nullptr, configs, room, count);
}

EGLBoolean GetConfigAttrib(EGLDisplay, EGLConfig config, EGLint attribute, EGLint* value) {
  if (config == nullptr) return failed(EGL_BAD_CONFIG, EGL_FALSE);
  return egl_attribute_of(*config_of(config), attribute, value) ? done() : failed(EGL_BAD_ATTRIBUTE, EGL_FALSE);
}

EGLBoolean BindAPI(EGLenum api) {
  if (api != EGL_OPENGL_API && api != EGL_OPENGL_ES_API) return failed(EGL_BAD_PARAMETER, EGL_FALSE);
  egl_thread.api = api;
  return done();
}

EGLenum QueryAPI() {
  return egl_thread.api;
}

EGLContext CreateContext(EGLDisplay display, EGLConfig config, EGLContext share, const EGLint* attributes) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_NO_CONTEXT);
  if (egl_thread.api != EGL_OPENGL_API) {
    say_no_opengl_es();
    return failed(EGL_BAD_MATCH, EGL_NO_CONTEXT);
  }
  RemoteContextWish wish;
  int major = 1;
  int minor = 0;
  bool core = true;
  for (; attributes != nullptr && attributes[0] != EGL_NONE; attributes += 2) {
    if (attributes[0] == EGL_CONTEXT_MAJOR_VERSION) major = attributes[1];
    if (attributes[0] == EGL_CONTEXT_MINOR_VERSION) minor = attributes[1];
    if (attributes[0] == EGL_CONTEXT_OPENGL_PROFILE_MASK)
      core = (attributes[1] & EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT) != 0;
  }
  wish.version = 100 * major + 10 * minor;
  wish.core = core && wish.version >= 320;
  int count = 0;
  const RemoteConfig* any = configs_of(*display_of(display), &count);
  const RemoteConfig* chosen = config != nullptr ? config_of(config) : any;
  RemoteContext* context =
      chosen != nullptr ? new_remote_context(*chosen, wish, static_cast<RemoteContext*>(share)) : nullptr;
  if (context == nullptr) return failed(EGL_BAD_MATCH, EGL_NO_CONTEXT);
  done();
  return context;
}

EGLBoolean DestroyContext(EGLDisplay, EGLContext context) {
  if (context == EGL_NO_CONTEXT) return failed(EGL_BAD_CONTEXT, EGL_FALSE);
  destroy_remote_context(static_cast<RemoteContext*>(context));
  return done();
}

EGLBoolean QueryContext(EGLDisplay, EGLContext context, EGLint attribute, EGLint* value) {
  if (context == EGL_NO_CONTEXT) return failed(EGL_BAD_CONTEXT, EGL_FALSE);
  switch (attribute) {
    case EGL_CONTEXT_CLIENT_TYPE:
      *value = EGL_OPENGL_API;
      return done();
    case EGL_CONFIG_ID:
      *value = static_cast<RemoteContext*>(context)->config.id;
      return done();
    case EGL_RENDER_BUFFER:
      *value = EGL_BACK_BUFFER;
      return done();
    default:
      return failed(EGL_BAD_ATTRIBUTE, EGL_FALSE);
  }
}

EGLSurface new_surface(EGLConfig config, XID window) {
  if (config == nullptr) return failed(EGL_BAD_CONFIG, EGL_NO_SURFACE);
  auto* surface = static_cast<Surface*>(calloc(1, sizeof(Surface)));
  if (surface == nullptr) return failed(EGL_BAD_ALLOC, EGL_NO_SURFACE);
  *surface = {window, 0, 0, config_of(config)->id, 1};
  done();
  return surface;
}

EGLSurface CreateWindowSurface(EGLDisplay display, EGLConfig config, EGLNativeWindowType window,
                               const EGLint*) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_NO_SURFACE);
  if (display_of(display)->x == nullptr || window == 0) return failed(EGL_BAD_NATIVE_WINDOW, EGL_NO_SURFACE);
  return new_surface(config, static_cast<XID>(window));
}

/// The X11 platforms pass a pointer to the window's id.
EGLSurface CreatePlatformWindowSurface(EGLDisplay display, EGLConfig config, void* window, const EGLAttrib*) {
  return CreateWindowSurface(display, config, window != nullptr ? *static_cast<Window*>(window) : 0, nullptr);
}

EGLSurface CreatePlatformWindowSurfaceEXT(EGLDisplay display, EGLConfig config, void* window, const EGLint*) {
  return CreatePlatformWindowSurface(display, config, window, nullptr);
}

EGLSurface CreatePbufferSurface(EGLDisplay, EGLConfig config, const EGLint* attributes) {
  EGLSurface made = new_surface(config, 0);
  for (; made != EGL_NO_SURFACE && attributes != nullptr && attributes[0] != EGL_NONE; attributes += 2) {
    if (attributes[0] == EGL_WIDTH) surface_of(made)->width = attributes[1];
    if (attributes[0] == EGL_HEIGHT) surface_of(made)->height = attributes[1];
  }
  return made;
}

EGLBoolean DestroySurface(EGLDisplay, EGLSurface surface) {
  if (surface == EGL_NO_SURFACE) return failed(EGL_BAD_SURFACE, EGL_FALSE);
  release(reinterpret_cast<std::uintptr_t>(surface));
  return done();
}

void extent_of_surface(const EglDisplay& display, const Surface& surface, int* width, int* height) {
  *width = surface.width;
  *height = surface.height;
  if (surface.window != 0 && display.x != nullptr) extent_of(display.x, surface.window, width, height);
}

EGLBoolean QuerySurface(EGLDisplay display, EGLSurface surface, EGLint attribute, EGLint* value) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  if (surface == EGL_NO_SURFACE) return failed(EGL_BAD_SURFACE, EGL_FALSE);
  int width = 0;
  int height = 0;
  extent_of_surface(*display_of(display), *surface_of(surface), &width, &height);
  switch (attribute) {
    case EGL_WIDTH:
      *value = width;
      return done();
    case EGL_HEIGHT:
      *value = height;
      return done();
    case EGL_CONFIG_ID:
      *value = surface_of(surface)->config;
      return done();
    case EGL_RENDER_BUFFER:
      *value = EGL_BACK_BUFFER;
      return done();
    case EGL_SWAP_BEHAVIOR:
      *value = EGL_BUFFER_DESTROYED;
      return done();
    default:
      return failed(EGL_BAD_ATTRIBUTE, EGL_FALSE);
  }
}

EGLBoolean MakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context) {
  if (context == EGL_NO_CONTEXT) {
    leave_surfaces();
    return done();
  }
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  const Xlib* x = xlib();
  if (display_of(display)->x != nullptr && x != nullptr) x->sync(display_of(display)->x, False);
  const CurrentSurfaces earlier = current_surfaces();
  const CurrentSurfaces next{reinterpret_cast<std::uintptr_t>(draw), reinterpret_cast<std::uintptr_t>(read)};
  acquire(next.draw);
  acquire(next.read);
  enter_remote_context(
      {WindowSystem::egl, static_cast<RemoteContext*>(context), display, next.draw, next.read});
  release(earlier.draw);
  release(earlier.read);
  return done();
}

EGLBoolean ReleaseThread() {
  leave_surfaces();
  egl_thread = {};
  return EGL_TRUE;
}

EGLContext GetCurrentContext() {
  return remote_thread(WindowSystem::egl).context;
}

EGLDisplay GetCurrentDisplay() {
  return remote_thread(WindowSystem::egl).display;
}

EGLSurface GetCurrentSurface(EGLint which) {
  const CurrentSurfaces current = current_surfaces();
  return reinterpret_cast<EGLSurface>(which == EGL_READ ? current.read : current.draw);
}

EGLBoolean SwapBuffers(EGLDisplay display, EGLSurface surface) {
  if (display == EGL_NO_DISPLAY) return failed(EGL_BAD_DISPLAY, EGL_FALSE);
  if (surface == EGL_NO_SURFACE) return failed(EGL_BAD_SURFACE, EGL_FALSE);
  const Xlib* x = xlib();
  if (display_of(display)->x != nullptr && x != nullptr) x->flush(display_of(display)->x);
  return done();
}

EGLBoolean SwapInterval(EGLDisplay, EGLint) {
  return done();
}

EGLBoolean Wait() {
  return done();
}

EGLBoolean WaitNative(EGLint) {
  return done();
}

EGLint GetError() {
  const EGLint error = egl_thread.error;
  egl_thread.error = EGL_SUCCESS;
  return error;
}

const NamedFunction functions[] = {
    {"eglBindAPI", reinterpret_cast<AnyRemoteFunction>(&BindAPI)},
    {"eglChooseConfig", reinterpret_cast<AnyRemoteFunction>(&ChooseConfig)},
    {"eglCreateContext", reinterpret_cast<AnyRemoteFunction>(&CreateContext)},
    {"eglCreatePbufferSurface", reinterpret_cast<AnyRemoteFunction>(&CreatePbufferSurface)},
    {"eglCreatePlatformWindowSurface", reinterpret_cast<AnyRemoteFunction>(&CreatePlatformWindowSurface)},
    {"eglCreatePlatformWindowSurfaceEXT", reinterpret_cast<AnyRemoteFunction>(&CreatePlatformWindowSurfaceEXT)},
    {"eglCreateWindowSurface", reinterpret_cast<AnyRemoteFunction>(&CreateWindowSurface)},
    {"eglDestroyContext", reinterpret_cast<AnyRemoteFunction>(&DestroyContext)},
    {"eglDestroySurface", reinterpret_cast<AnyRemoteFunction>(&DestroySurface)},
    {"eglGetConfigAttrib", reinterpret_cast<AnyRemoteFunction>(&GetConfigAttrib)},
    {"eglGetConfigs", reinterpret_cast<AnyRemoteFunction>(&GetConfigs)},
    {"eglGetCurrentContext", reinterpret_cast<AnyRemoteFunction>(&GetCurrentContext)},
    {"eglGetCurrentDisplay", reinterpret_cast<AnyRemoteFunction>(&GetCurrentDisplay)},
    {"eglGetCurrentSurface", reinterpret_cast<AnyRemoteFunction>(&GetCurrentSurface)},
    {"eglGetDisplay", reinterpret_cast<AnyRemoteFunction>(&GetDisplay)},
    {"eglGetError", reinterpret_cast<AnyRemoteFunction>(&GetError)},
    {"eglGetPlatformDisplay", reinterpret_cast<AnyRemoteFunction>(&GetPlatformDisplay)},
    {"eglGetPlatformDisplayEXT", reinterpret_cast<AnyRemoteFunction>(&GetPlatformDisplayEXT)},
    {"eglInitialize", reinterpret_cast<AnyRemoteFunction>(&Initialize)},
    {"eglMakeCurrent", reinterpret_cast<AnyRemoteFunction>(&MakeCurrent)},
    {"eglQueryAPI", reinterpret_cast<AnyRemoteFunction>(&QueryAPI)},
    {"eglQueryContext", reinterpret_cast<AnyRemoteFunction>(&QueryContext)},
    {"eglQueryString", reinterpret_cast<AnyRemoteFunction>(&QueryString)},
    {"eglQuerySurface", reinterpret_cast<AnyRemoteFunction>(&QuerySurface)},
    {"eglReleaseThread", reinterpret_cast<AnyRemoteFunction>(&ReleaseThread)},
    {"eglSwapBuffers", reinterpret_cast<AnyRemoteFunction>(&SwapBuffers)},
    {"eglSwapInterval", reinterpret_cast<AnyRemoteFunction>(&SwapInterval)},
    {"eglTerminate", reinterpret_cast<AnyRemoteFunction>(&Terminate)},
    {"eglWaitClient", reinterpret_cast<AnyRemoteFunction>(&Wait)},
    {"eglWaitGL", reinterpret_cast<AnyRemoteFunction>(&Wait)},
    {"eglWaitNative", reinterpret_cast<AnyRemoteFunction>(&WaitNative)},
};

}  // namespace

void* remote_egl_symbol(const char* name) {
  return find_function(functions, name);
}

void remote_egl_drawable(void* display, std::uintptr_t surface, RemoteDrawable* answer) {
  *answer = {};
  if (surface == 0) return;
  const Surface& of = *reinterpret_cast<const Surface*>(surface);
  extent_of_surface(*static_cast<EglDisplay*>(display), of, &answer->width, &answer->height);
  answer->number = of.window != 0 ? of.window : surface;
  if (of.window != 0) answer->display = reinterpret_cast<std::uintptr_t>(static_cast<EglDisplay*>(display)->x);
}

}  // namespace understudy::interceptor
