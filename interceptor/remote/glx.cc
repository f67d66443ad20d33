// SPDX-License-Identifier: Apache-2.0
#include <GL/glx.h>
#include <GL/glxext.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <atomic>

#include "interceptor/entry_thread.h"
#include "interceptor/log_line.h"
#include "interceptor/remote/configs.h"
#include "interceptor/remote/context.h"
#include "interceptor/remote/glx_config.h"
#include "interceptor/remote/named_function.h"
#include "interceptor/remote/x_server.h"

namespace understudy::interceptor {
namespace {

constexpr const char* extensions =
    "GLX_ARB_create_context GLX_ARB_create_context_profile GLX_ARB_get_proc_address GLX_ARB_multisample "
    "GLX_EXT_swap_control GLX_EXT_visual_info GLX_EXT_visual_rating GLX_MESA_swap_control "
    "GLX_SGI_make_current_read GLX_SGI_swap_control GLX_SGIX_fbconfig GLX_SGIX_pbuffer";

/// Drawables of glXCreatePbuffer, which the X server does not know.
struct Pbuffer {
  XID id;
  int width;
  int height;
  int config;
  Pbuffer* next;
};

constinit pthread_mutex_t pbuffer_lock = PTHREAD_MUTEX_INITIALIZER;
constinit Pbuffer* pbuffers = nullptr;

const RemoteConfig* config_of(GLXFBConfig config) {
  return reinterpret_cast<const RemoteConfig*>(config);
}

GLXFBConfig handle_of(const RemoteConfig& config) {
  return reinterpret_cast<GLXFBConfig>(const_cast<RemoteConfig*>(&config));
}

RemoteContext* context_of(GLXContext context) {
  return reinterpret_cast<RemoteContext*>(context);
}

/// A configuration of the visual, for functions that identify configurations by visual alone.
const RemoteConfig* config_of_visual(Display* display, const XVisualInfo* visual) {
  int count = 0;
  const RemoteConfig* configs = remote_configs(display, visual->screen, &count);
  for (int i = 0; i < count; ++i) {
    if (configs[i].visual == visual->visualid) return &configs[i];
  }
  return nullptr;
}

GLXFBConfig* ChooseFBConfig(Display* display, int screen, const int* attributes, int* count) {
  int offered = 0;
  const RemoteConfig* configs = remote_configs(display, screen, &offered);
  *count = 0;
  // The application frees it with XFree, which calls free.
  auto* chosen = static_cast<GLXFBConfig*>(malloc(sizeof(GLXFBConfig) * static_cast<size_t>(offered + 1)));
  if (chosen == nullptr) return nullptr;
  for (int i = 0; i < offered; ++i) {
    if (meets_glx(configs[i], attributes)) chosen[(*count)++] = handle_of(configs[i]);
  }
  if (*count > 0) return chosen;
  free(chosen);
  return nullptr;
}

GLXFBConfig* GetFBConfigs(Display* display, int screen, int* count) {
  return ChooseFBConfig(display, screen, nullptr, count);
}

int GetFBConfigAttrib(Display*, GLXFBConfig config, int attribute, int* value) {
  return config != nullptr ? glx_attribute_of(*config_of(config), attribute, value) : GLX_BAD_VISUAL;
}

XVisualInfo* GetVisualFromFBConfig(Display* display, GLXFBConfig config) {
  return config != nullptr ? visual_of(display, *config_of(config)) : nullptr;
}

/// Takes GLX 1.2's attribute list, in which some attributes are flags without a value.
XVisualInfo* ChooseVisual(Display* display, int screen, int* attributes) {
  int wanted[64];
  int length = 0;
  bool double_buffered = false;
  bool rgba = false;
  for (; attributes != nullptr && *attributes != None; ++attributes) {
    if (*attributes == GLX_USE_GL) continue;
    if (*attributes == GLX_RGBA) {
      rgba = true;
    } else if (*attributes == GLX_DOUBLEBUFFER) {
      double_buffered = true;
    } else if (*attributes == GLX_STEREO) {
      return nullptr;
    } else {
      const int name = *attributes;
      const int value = *++attributes;
      if (length + 4 >= 64) continue;
      wanted[length++] = name;
      wanted[length++] = value;
    }
  }
  if (!rgba) return nullptr;
  wanted[length++] = GLX_DOUBLEBUFFER;
  wanted[length++] = double_buffered ? 1 : 0;
  wanted[length] = None;
  int offered = 0;
  const RemoteConfig* configs = remote_configs(display, screen, &offered);
  for (int i = 0; i < offered; ++i) {
    if (!meets_glx(configs[i], wanted)) continue;
    note_choice(configs[i]);
    return visual_of(display, configs[i]);
  }
  return nullptr;
}

int GetConfig(Display* display, XVisualInfo* visual, int attribute, int* value) {
  const RemoteConfig* config = visual != nullptr ? config_of_visual(display, visual) : nullptr;
  if (config != nullptr) return glx_attribute_of(*config, attribute, value);
  *value = 0;
  return attribute == GLX_USE_GL ? Success : GLX_BAD_VISUAL;
}

GLXContext CreateContext(Display* display, XVisualInfo* visual, GLXContext share, Bool) {
  const RemoteConfig* config = visual != nullptr ? config_of_visual(display, visual) : nullptr;
  if (config == nullptr) return nullptr;
  return reinterpret_cast<GLXContext>(new_remote_context(chosen_for(*config), {}, context_of(share)));
}

GLXContext CreateNewContext(Display*, GLXFBConfig config, int, GLXContext share, Bool) {
  if (config == nullptr) return nullptr;
  return reinterpret_cast<GLXContext>(new_remote_context(*config_of(config), {}, context_of(share)));
}

GLXContext CreateContextWithConfigSGIX(Display* display, GLXFBConfigSGIX config, int type, GLXContext share,
                                       Bool direct) {
  return CreateNewContext(display, config, type, share, direct);
}

GLXContext CreateContextAttribsARB(Display*, GLXFBConfig config, GLXContext share, Bool,
                                   const int* attributes) {
  RemoteContextWish wish;
  int major = 1;
  int minor = 0;
  bool profile_given = false;
  for (; attributes != nullptr && attributes[0] != None; attributes += 2) {
    switch (attributes[0]) {
      case GLX_CONTEXT_MAJOR_VERSION_ARB:
        major = attributes[1];
        break;
      case GLX_CONTEXT_MINOR_VERSION_ARB:
        minor = attributes[1];
        break;
      case GLX_CONTEXT_PROFILE_MASK_ARB:
        if ((attributes[1] & ~(GLX_CONTEXT_CORE_PROFILE_BIT_ARB | GLX_CONTEXT_COMPATIBILITY_PROFILE_BIT_ARB)) !=
            0) {
          say_no_opengl_es();
          return nullptr;
        }
        wish.core = (attributes[1] & GLX_CONTEXT_CORE_PROFILE_BIT_ARB) != 0;
        profile_given = true;
        break;
      default:
        break;
    }
  }
  wish.version = 100 * major + 10 * minor;
  // GLX_ARB_create_context_profile: core if no profile is given; before 3.2 there are no profiles.
  if (!profile_given || wish.version < 320) wish.core = wish.version >= 320;
  if (config == nullptr) return nullptr;
  return reinterpret_cast<GLXContext>(new_remote_context(*config_of(config), wish, context_of(share)));
}

/// Most of a context's state can be queried only while it is current, and the GL server's EGL cannot copy it.
void CopyContext(Display*, GLXContext, GLXContext, unsigned long) {
  static constinit std::atomic_flag said{};
  if (said.test_and_set()) return;
  log_line(logging::Level::warn,
           "the viewer calls glXCopyContext, which run --remote does not offer; the state of its second "
           "context stays as it is, so what it draws there may look different: run it without --remote");
}

void DestroyContext(Display*, GLXContext context) {
  destroy_remote_context(context_of(context));
}

Bool make_current(Display* display, GLXDrawable draw, GLXDrawable read, GLXContext context) {
  if (context == nullptr) {
    leave_remote_context(WindowSystem::glx);
    return True;
  }
  // The server must have processed the window's creation before our own connection asks for the window.
  if (const Xlib* x = xlib()) x->sync(display, False);
  enter_remote_context({WindowSystem::glx, context_of(context), display, draw, read});
  return True;
}

Bool MakeCurrent(Display* display, GLXDrawable drawable, GLXContext context) {
  return make_current(display, drawable, drawable, context);
}

Bool MakeContextCurrent(Display* display, GLXDrawable draw, GLXDrawable read, GLXContext context) {
  return make_current(display, draw, read, context);
}

GLXContext GetCurrentContext() {
  return reinterpret_cast<GLXContext>(remote_thread(WindowSystem::glx).context);
}

Display* GetCurrentDisplay() {
  return static_cast<Display*>(remote_thread(WindowSystem::glx).display);
}

GLXDrawable GetCurrentDrawable() {
  return remote_thread(WindowSystem::glx).draw;
}

GLXDrawable GetCurrentReadDrawable() {
  return remote_thread(WindowSystem::glx).read;
}

/// The frame's image follows at the end of the frame; what the application has requested of its windows must
/// reach the server first.
void SwapBuffers(Display* display, GLXDrawable) {
  if (const Xlib* x = xlib()) x->flush(display);
}

Bool IsDirect(Display*, GLXContext) {
  return True;
}

Bool QueryExtension(Display*, int* error_base, int* event_base) {
  if (error_base != nullptr) *error_base = 0;
  if (event_base != nullptr) *event_base = 0;
  return True;
}

Bool QueryVersion(Display*, int* major, int* minor) {
  if (major != nullptr) *major = 1;
  if (minor != nullptr) *minor = 4;
  return True;
}

const char* QueryExtensionsString(Display*, int) {
  return extensions;
}

const char* GetClientString(Display*, int name) {
  switch (name) {
    case GLX_VENDOR:
      return "Understudy";
    case GLX_VERSION:
      return "1.4";
    case GLX_EXTENSIONS:
      return extensions;
    default:
      return nullptr;
  }
}

const char* QueryServerString(Display* display, int, int name) {
  return GetClientString(display, name);
}

int QueryContext(Display*, GLXContext context, int attribute, int* value) {
  if (context == nullptr) return GLX_BAD_CONTEXT;
  const RemoteContext& asked = *context_of(context);
  if (attribute == GLX_RENDER_TYPE) {
    *value = GLX_RGBA_TYPE;
    return Success;
  }
  return attribute == GLX_FBCONFIG_ID || attribute == GLX_SCREEN
             ? glx_attribute_of(asked.config, attribute, value)
             : GLX_BAD_ATTRIBUTE;
}

GLXPbuffer CreatePbuffer(Display* display, GLXFBConfig config, const int* attributes) {
  const XID id = config != nullptr ? new_id(display) : None;
  auto* made = id != None ? static_cast<Pbuffer*>(calloc(1, sizeof(Pbuffer))) : nullptr;
  if (made == nullptr) return None;
  for (; attributes != nullptr && attributes[0] != None; attributes += 2) {
    if (attributes[0] == GLX_PBUFFER_WIDTH) made->width = attributes[1];
    if (attributes[0] == GLX_PBUFFER_HEIGHT) made->height = attributes[1];
  }
  made->id = id;
  made->config = config_of(config)->id;
  pthread_mutex_lock(&pbuffer_lock);
  made->next = pbuffers;
  pbuffers = made;
  pthread_mutex_unlock(&pbuffer_lock);
  return made->id;
}

GLXPbufferSGIX CreateGLXPbufferSGIX(Display* display, GLXFBConfigSGIX config, unsigned width, unsigned height,
                                    int*) {
  const int attributes[] = {GLX_PBUFFER_WIDTH, static_cast<int>(width), GLX_PBUFFER_HEIGHT,
                            static_cast<int>(height), None};
  return CreatePbuffer(display, config, attributes);
}

void DestroyPbuffer(Display*, GLXPbuffer id) {
  pthread_mutex_lock(&pbuffer_lock);
  for (Pbuffer** link = &pbuffers; *link != nullptr; link = &(*link)->next) {
    if ((*link)->id != id) continue;
    Pbuffer* gone = *link;
    *link = gone->next;
    free(gone);
    break;
  }
  pthread_mutex_unlock(&pbuffer_lock);
}

GLXWindow CreateWindow(Display*, GLXFBConfig, Window window, const int*) {
  return window;
}

GLXPixmap CreatePixmap(Display*, GLXFBConfig, Pixmap pixmap, const int*) {
  return pixmap;
}

GLXPixmap CreateGLXPixmap(Display*, XVisualInfo*, Pixmap pixmap) {
  return pixmap;
}

void destroy_nothing(Display*, GLXDrawable) {}

bool extent_of_pbuffer(XID drawable, int* width, int* height) {
  pthread_mutex_lock(&pbuffer_lock);
  const Pbuffer* pbuffer = pbuffers;
  while (pbuffer != nullptr && pbuffer->id != drawable) pbuffer = pbuffer->next;
  if (pbuffer != nullptr) {
    *width = pbuffer->width;
    *height = pbuffer->height;
  }
  pthread_mutex_unlock(&pbuffer_lock);
  return pbuffer != nullptr;
}

void QueryDrawable(Display* display, GLXDrawable drawable, int attribute, unsigned* value) {
  int width = 0;
  int height = 0;
  if (!extent_of_pbuffer(drawable, &width, &height)) extent_of(display, drawable, &width, &height);
  switch (attribute) {
    case GLX_WIDTH:
      *value = static_cast<unsigned>(width);
      return;
    case GLX_HEIGHT:
      *value = static_cast<unsigned>(height);
      return;
    case GLX_PRESERVED_CONTENTS:
      *value = True;
      return;
    case GLX_SWAP_INTERVAL_EXT:
      *value = 0;
      return;
    case GLX_MAX_SWAP_INTERVAL_EXT:
      *value = 1;
      return;
    default:
      *value = 0;
  }
}

int QueryGLXPbufferSGIX(Display* display, GLXPbufferSGIX pbuffer, int attribute, unsigned* value) {
  QueryDrawable(display, pbuffer, attribute, value);
  return 0;
}

GLXFBConfigSGIX GetFBConfigFromVisualSGIX(Display* display, XVisualInfo* visual) {
  const RemoteConfig* config = visual != nullptr ? config_of_visual(display, visual) : nullptr;
  return config != nullptr ? handle_of(*config) : nullptr;
}

/// Only its presence is checked: the exported entry point does the work.
void UseXFont(Font, int, int, int) {}

void wait() {}

// Frames are shown as soon as they are drawn, whatever interval was requested.
int SwapIntervalSGI(int) {
  return 0;
}
int SwapIntervalMESA(unsigned) {
  return 0;
}
int GetSwapIntervalMESA() {
  return 0;
}
void SwapIntervalEXT(Display*, GLXDrawable, int) {}

void SelectEvent(Display*, GLXDrawable, unsigned long) {}

void GetSelectedEvent(Display*, GLXDrawable, unsigned long* mask) {
  *mask = 0;
}

const NamedFunction functions[] = {
    {"glXChooseFBConfig", reinterpret_cast<AnyRemoteFunction>(&ChooseFBConfig)},
    {"glXChooseFBConfigSGIX", reinterpret_cast<AnyRemoteFunction>(&ChooseFBConfig)},
    {"glXChooseVisual", reinterpret_cast<AnyRemoteFunction>(&ChooseVisual)},
    {"glXCopyContext", reinterpret_cast<AnyRemoteFunction>(&CopyContext)},
    {"glXCreateContext", reinterpret_cast<AnyRemoteFunction>(&CreateContext)},
    {"glXCreateContextAttribsARB", reinterpret_cast<AnyRemoteFunction>(&CreateContextAttribsARB)},
    {"glXCreateContextWithConfigSGIX", reinterpret_cast<AnyRemoteFunction>(&CreateContextWithConfigSGIX)},
    {"glXCreateGLXPbufferSGIX", reinterpret_cast<AnyRemoteFunction>(&CreateGLXPbufferSGIX)},
    {"glXCreateGLXPixmap", reinterpret_cast<AnyRemoteFunction>(&CreateGLXPixmap)},
    {"glXCreateNewContext", reinterpret_cast<AnyRemoteFunction>(&CreateNewContext)},
    {"glXCreatePbuffer", reinterpret_cast<AnyRemoteFunction>(&CreatePbuffer)},
    {"glXCreatePixmap", reinterpret_cast<AnyRemoteFunction>(&CreatePixmap)},
    {"glXCreateWindow", reinterpret_cast<AnyRemoteFunction>(&CreateWindow)},
    {"glXDestroyContext", reinterpret_cast<AnyRemoteFunction>(&DestroyContext)},
    {"glXDestroyGLXPbufferSGIX", reinterpret_cast<AnyRemoteFunction>(&DestroyPbuffer)},
    {"glXDestroyGLXPixmap", reinterpret_cast<AnyRemoteFunction>(&destroy_nothing)},
    {"glXDestroyPbuffer", reinterpret_cast<AnyRemoteFunction>(&DestroyPbuffer)},
    {"glXDestroyPixmap", reinterpret_cast<AnyRemoteFunction>(&destroy_nothing)},
    {"glXDestroyWindow", reinterpret_cast<AnyRemoteFunction>(&destroy_nothing)},
    {"glXGetClientString", reinterpret_cast<AnyRemoteFunction>(&GetClientString)},
    {"glXGetConfig", reinterpret_cast<AnyRemoteFunction>(&GetConfig)},
    {"glXGetCurrentContext", reinterpret_cast<AnyRemoteFunction>(&GetCurrentContext)},
    {"glXGetCurrentDisplay", reinterpret_cast<AnyRemoteFunction>(&GetCurrentDisplay)},
    {"glXGetCurrentDisplayEXT", reinterpret_cast<AnyRemoteFunction>(&GetCurrentDisplay)},
    {"glXGetCurrentDrawable", reinterpret_cast<AnyRemoteFunction>(&GetCurrentDrawable)},
    {"glXGetCurrentReadDrawable", reinterpret_cast<AnyRemoteFunction>(&GetCurrentReadDrawable)},
    {"glXGetCurrentReadDrawableSGI", reinterpret_cast<AnyRemoteFunction>(&GetCurrentReadDrawable)},
    {"glXGetFBConfigAttrib", reinterpret_cast<AnyRemoteFunction>(&GetFBConfigAttrib)},
    {"glXGetFBConfigAttribSGIX", reinterpret_cast<AnyRemoteFunction>(&GetFBConfigAttrib)},
    {"glXGetFBConfigFromVisualSGIX", reinterpret_cast<AnyRemoteFunction>(&GetFBConfigFromVisualSGIX)},
    {"glXGetFBConfigs", reinterpret_cast<AnyRemoteFunction>(&GetFBConfigs)},
    {"glXGetSelectedEvent", reinterpret_cast<AnyRemoteFunction>(&GetSelectedEvent)},
    {"glXGetSwapIntervalMESA", reinterpret_cast<AnyRemoteFunction>(&GetSwapIntervalMESA)},
    {"glXGetVisualFromFBConfig", reinterpret_cast<AnyRemoteFunction>(&GetVisualFromFBConfig)},
    {"glXGetVisualFromFBConfigSGIX", reinterpret_cast<AnyRemoteFunction>(&GetVisualFromFBConfig)},
    {"glXIsDirect", reinterpret_cast<AnyRemoteFunction>(&IsDirect)},
    {"glXMakeContextCurrent", reinterpret_cast<AnyRemoteFunction>(&MakeContextCurrent)},
    {"glXMakeCurrent", reinterpret_cast<AnyRemoteFunction>(&MakeCurrent)},
    {"glXMakeCurrentReadSGI", reinterpret_cast<AnyRemoteFunction>(&MakeContextCurrent)},
    {"glXQueryContext", reinterpret_cast<AnyRemoteFunction>(&QueryContext)},
    {"glXQueryDrawable", reinterpret_cast<AnyRemoteFunction>(&QueryDrawable)},
    {"glXQueryExtension", reinterpret_cast<AnyRemoteFunction>(&QueryExtension)},
    {"glXQueryExtensionsString", reinterpret_cast<AnyRemoteFunction>(&QueryExtensionsString)},
    {"glXQueryGLXPbufferSGIX", reinterpret_cast<AnyRemoteFunction>(&QueryGLXPbufferSGIX)},
    {"glXQueryServerString", reinterpret_cast<AnyRemoteFunction>(&QueryServerString)},
    {"glXQueryVersion", reinterpret_cast<AnyRemoteFunction>(&QueryVersion)},
    {"glXSelectEvent", reinterpret_cast<AnyRemoteFunction>(&SelectEvent)},
    {"glXSwapBuffers", reinterpret_cast<AnyRemoteFunction>(&SwapBuffers)},
    {"glXSwapIntervalEXT", reinterpret_cast<AnyRemoteFunction>(&SwapIntervalEXT)},
    {"glXSwapIntervalMESA", reinterpret_cast<AnyRemoteFunction>(&SwapIntervalMESA)},
    {"glXSwapIntervalSGI", reinterpret_cast<AnyRemoteFunction>(&SwapIntervalSGI)},
    {"glXUseXFont", reinterpret_cast<AnyRemoteFunction>(&UseXFont)},
    {"glXWaitGL", reinterpret_cast<AnyRemoteFunction>(&wait)},
    {"glXWaitX", reinterpret_cast<AnyRemoteFunction>(&wait)},
};

}  // namespace

void* remote_glx_symbol(const char* name) {
  return find_function(functions, name);
}

void remote_glx_drawable(void* display, std::uintptr_t drawable, RemoteDrawable* answer) {
  *answer = {};
  if (drawable == None) return;
  auto* server = static_cast<Display*>(display);
  if (extent_of_pbuffer(drawable, &answer->width, &answer->height)) {
    answer->number = drawable;
  } else if (extent_of(server, drawable, &answer->width, &answer->height)) {
    answer->number = drawable;
    answer->display = reinterpret_cast<std::uintptr_t>(server);
  }
}

}  // namespace understudy::interceptor
