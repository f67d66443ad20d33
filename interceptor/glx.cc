// SPDX-License-Identifier: Apache-2.0
// The GLX functions that create, destroy or switch contexts, end a frame, return addresses, or make calls of
// OpenGL. The others are generated.
#include <GL/glx.h>

#include <cstring>

#include "interceptor/life_cycle.h"
#include "interceptor/real_function.h"
#include "interceptor/remote.h"
#include "interceptor/x_font.h"

namespace understudy::interceptor {
namespace {

std::uintptr_t number(const void* handle) {
  return reinterpret_cast<std::uintptr_t>(handle);
}

constexpr WindowSystem glx = WindowSystem::glx;

GLXContext created(Display* display, GLXContext context, GLXContext share, bool desktop_gl = true) {
  if (context != nullptr && concerns_core()) {
    note_created({glx, number(display), number(context)}, number(share), desktop_gl);
    report_gone();
  }
  return context;
}

/// False for GLX_EXT_create_context_es2_profile, the only way to create a GL ES context through GLX.
bool asks_for_desktop_gl(const int* attributes) {
  for (; attributes != nullptr && attributes[0] != None; attributes += 2) {
    if (attributes[0] == GLX_CONTEXT_PROFILE_MASK_ARB &&
        (attributes[1] & GLX_CONTEXT_ES2_PROFILE_BIT_EXT) != 0) {
      return false;
    }
  }
  return true;
}

using VoidFunction = void (*)();

/// Our entry point for a name that we export and the driver has; otherwise what the driver returns.
VoidFunction proc_address(const char* name) {
  void* real = real_proc_address(glx, name);
  if (real == nullptr || entry_thread.level > 0) return reinterpret_cast<VoidFunction>(real);
  void* own = std::strncmp(name, "gl", 2) == 0 ? own_entry(name) : nullptr;
  return reinterpret_cast<VoidFunction>(own != nullptr ? own : real);
}

Bool make_current_read(Display* display, GLXDrawable draw, GLXDrawable read, GLXContext context,
                       RealFunction<Bool (*)(Display*, GLXDrawable, GLXDrawable, GLXContext)>& real) {
  return make_current({glx, number(display), number(context), draw, read},
                      [&] { return real(display, draw, read, context); });
}

void destroy(Display* display, GLXContext context, RealFunction<void (*)(Display*, GLXContext)>& real) {
  const bool told = concerns_core();
  const ContextKey key{glx, number(display), number(context)};
  if (told) before_destroy(key);
  real(display, context);
  if (told) after_destroy(key);
}

}  // namespace
}  // namespace understudy::interceptor

using namespace understudy::interceptor;

UNDERSTUDY_ENTRY GLXContext glXCreateContext(Display* display, XVisualInfo* visual, GLXContext share,
                                             Bool direct) {
  static constinit RealFunction<GLXContext (*)(Display*, XVisualInfo*, GLXContext, Bool)> real{
      glx, "glXCreateContext"};
  return created(display, real(display, visual, share, direct), share);
}

UNDERSTUDY_ENTRY GLXContext glXCreateNewContext(Display* display, GLXFBConfig config, int render_type,
                                                GLXContext share, Bool direct) {
  static constinit RealFunction<GLXContext (*)(Display*, GLXFBConfig, int, GLXContext, Bool)> real{
      glx, "glXCreateNewContext"};
  return created(display, real(display, config, render_type, share, direct), share);
}

UNDERSTUDY_ENTRY GLXContext glXCreateContextWithConfigSGIX(Display* display, GLXFBConfigSGIX config,
                                                           int render_type, GLXContext share, Bool direct) {
  static constinit RealFunction<GLXContext (*)(Display*, GLXFBConfigSGIX, int, GLXContext, Bool)> real{
      glx, "glXCreateContextWithConfigSGIX"};
  return created(display, real(display, config, render_type, share, direct), share);
}

UNDERSTUDY_ENTRY GLXContext glXCreateContextAttribsARB(Display* display, GLXFBConfig config, GLXContext share,
                                                       Bool direct, const int* attributes) {
  static constinit RealFunction<GLXContext (*)(Display*, GLXFBConfig, GLXContext, Bool, const int*)> real{
      glx, "glXCreateContextAttribsARB"};
  return created(display, real(display, config, share, direct, attributes), share,
                 asks_for_desktop_gl(attributes));
}

UNDERSTUDY_ENTRY GLXContext glXImportContextEXT(Display* display, GLXContextID id) {
  static constinit RealFunction<GLXContext (*)(Display*, GLXContextID)> real{glx, "glXImportContextEXT"};
  return created(display, real(display, id), nullptr);
}

UNDERSTUDY_ENTRY void glXDestroyContext(Display* display, GLXContext context) {
  static constinit RealFunction<void (*)(Display*, GLXContext)> real{glx, "glXDestroyContext"};
  destroy(display, context, real);
}

UNDERSTUDY_ENTRY void glXFreeContextEXT(Display* display, GLXContext context) {
  static constinit RealFunction<void (*)(Display*, GLXContext)> real{glx, "glXFreeContextEXT"};
  destroy(display, context, real);
}

UNDERSTUDY_ENTRY Bool glXMakeCurrent(Display* display, GLXDrawable drawable, GLXContext context) {
  static constinit RealFunction<Bool (*)(Display*, GLXDrawable, GLXContext)> real{glx, "glXMakeCurrent"};
  return make_current({glx, number(display), number(context), drawable, drawable},
                      [&] { return real(display, drawable, context); });
}

UNDERSTUDY_ENTRY Bool glXMakeContextCurrent(Display* display, GLXDrawable draw, GLXDrawable read,
                                            GLXContext context) {
  static constinit RealFunction<Bool (*)(Display*, GLXDrawable, GLXDrawable, GLXContext)> real{
      glx, "glXMakeContextCurrent"};
  return make_current_read(display, draw, read, context, real);
}

UNDERSTUDY_ENTRY Bool glXMakeCurrentReadSGI(Display* display, GLXDrawable draw, GLXDrawable read,
                                            GLXContext context) {
  static constinit RealFunction<Bool (*)(Display*, GLXDrawable, GLXDrawable, GLXContext)> real{
      glx, "glXMakeCurrentReadSGI"};
  return make_current_read(display, draw, read, context, real);
}

UNDERSTUDY_ENTRY void glXSwapBuffers(Display* display, GLXDrawable drawable) {
  static constinit RealFunction<void (*)(Display*, GLXDrawable)> real{glx, "glXSwapBuffers"};
  end_frame(
      FrameEnd::swap, [&] { real(display, drawable); }, drawable);
}

UNDERSTUDY_ENTRY int64_t glXSwapBuffersMscOML(Display* display, GLXDrawable drawable, int64_t target_msc,
                                              int64_t divisor, int64_t remainder) {
  static constinit RealFunction<int64_t (*)(Display*, GLXDrawable, int64_t, int64_t, int64_t)> real{
      glx, "glXSwapBuffersMscOML"};
  return end_frame(
      FrameEnd::swap, [&] { return real(display, drawable, target_msc, divisor, remainder); }, drawable);
}

UNDERSTUDY_ENTRY void glXCopySubBufferMESA(Display* display, GLXDrawable drawable, int x, int y, int width,
                                           int height) {
  static constinit RealFunction<void (*)(Display*, GLXDrawable, int, int, int, int)> real{
      glx, "glXCopySubBufferMESA"};
  end_frame(FrameEnd::swap, [&] { real(display, drawable, x, y, width, height); });
}

UNDERSTUDY_ENTRY void glXWaitGL() {
  static constinit RealFunction<void (*)()> real{glx, "glXWaitGL"};
  end_frame(FrameEnd::wait, [&] { real(); });
}

UNDERSTUDY_ENTRY void glXUseXFont(Font font, int first, int count, int list) {
  static constinit RealFunction<void (*)(Font, int, int, int)> real{glx, "glXUseXFont"};
  // With remote OpenGL the entry library implements this itself, by GL calls through the application's table.
  const CurrentContext& current = entry_thread.current;
  const understudy::spu::DispatchTable* table = entry_thread.state.table;
  if (!is_remote()) return real(font, first, count, list);
  if (table == nullptr || current.context == 0 || current.system != glx) return;
  make_lists_of_font(*table, reinterpret_cast<Display*>(current.display), font, first, count, list);
}

UNDERSTUDY_ENTRY VoidFunction glXGetProcAddress(const GLubyte* name) {
  return proc_address(reinterpret_cast<const char*>(name));
}

UNDERSTUDY_ENTRY VoidFunction glXGetProcAddressARB(const GLubyte* name) {
  return proc_address(reinterpret_cast<const char*>(name));
}

// Toolkits call these to find out whether GLX is in use. While GLX's library is not open, nothing is current,
// and opening it would load a second window system into a program that uses EGL.

UNDERSTUDY_ENTRY GLXContext glXGetCurrentContext() {
  static constinit RealFunction<GLXContext (*)()> real{glx, "glXGetCurrentContext"};
  return driver_is_open(glx) ? real() : nullptr;
}

UNDERSTUDY_ENTRY Display* glXGetCurrentDisplay() {
  static constinit RealFunction<Display* (*)()> real{glx, "glXGetCurrentDisplay"};
  return driver_is_open(glx) ? real() : nullptr;
}

UNDERSTUDY_ENTRY Display* glXGetCurrentDisplayEXT() {
  static constinit RealFunction<Display* (*)()> real{glx, "glXGetCurrentDisplayEXT"};
  return driver_is_open(glx) ? real() : nullptr;
}

UNDERSTUDY_ENTRY GLXDrawable glXGetCurrentDrawable() {
  static constinit RealFunction<GLXDrawable (*)()> real{glx, "glXGetCurrentDrawable"};
  return driver_is_open(glx) ? real() : None;
}

UNDERSTUDY_ENTRY GLXDrawable glXGetCurrentReadDrawable() {
  static constinit RealFunction<GLXDrawable (*)()> real{glx, "glXGetCurrentReadDrawable"};
  return driver_is_open(glx) ? real() : None;
}

UNDERSTUDY_ENTRY GLXDrawable glXGetCurrentReadDrawableSGI() {
  static constinit RealFunction<GLXDrawable (*)()> real{glx, "glXGetCurrentReadDrawableSGI"};
  return driver_is_open(glx) ? real() : None;
}
