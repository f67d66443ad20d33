// SPDX-License-Identifier: Apache-2.0
// The EGL functions that create, destroy or switch contexts, end or publish a frame, or return addresses. The
// others are generated.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstring>

#include "interceptor/life_cycle.h"
#include "interceptor/real_function.h"

namespace understudy::interceptor {
namespace {

std::uintptr_t number(const void* handle) {
  return reinterpret_cast<std::uintptr_t>(handle);
}

constexpr WindowSystem egl = WindowSystem::egl;

/// EGL_OPENGL_API, EGL_OPENGL_ES_API or EGL_OPENVG_API; 0 if the query fails.
EGLint client_type(EGLDisplay display, EGLContext context) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLContext, EGLint, EGLint*)> query{
      egl, "eglQueryContext"};
  EGLint type = 0;
  return query(display, context, EGL_CONTEXT_CLIENT_TYPE, &type) == EGL_TRUE ? type : 0;
}

EGLBoolean make_current_egl(EGLDisplay display, EGLSurface draw, EGLSurface read, EGLContext context) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, EGLSurface, EGLContext)> real{
      egl, "eglMakeCurrent"};
  const auto real_call = [&] { return real(display, draw, read, context); };
  if (!concerns_core()) return real_call();
  WantedContext wanted{egl, number(display), number(context), number(draw), number(read)};
  if (context != EGL_NO_CONTEXT && !is_noted({egl, wanted.display, wanted.handle})) {
    // An invalid handle makes this query fail and set an error; the real call then sets the same error.
    const EGLint type = client_type(display, context);
    if (type == EGL_OPENVG_API) return real_call();  // current beside OpenGL, not instead of it
    wanted.desktop_gl_if_new = type == EGL_OPENGL_API;
  }
  return make_current(wanted, real_call);
}

}  // namespace
}  // namespace understudy::interceptor

using namespace understudy::interceptor;
using VoidFunction = void (*)();

UNDERSTUDY_ENTRY EGLContext eglCreateContext(EGLDisplay display, EGLConfig config, EGLContext share,
                                             const EGLint* attributes) {
  static constinit RealFunction<EGLContext (*)(EGLDisplay, EGLConfig, EGLContext, const EGLint*)> real{
      egl, "eglCreateContext"};
  static constinit RealFunction<EGLenum (*)()> query_api{egl, "eglQueryAPI"};
  const bool told = concerns_core();
  const EGLenum api = told ? query_api() : EGL_NONE;
  EGLContext context = real(display, config, share, attributes);
  if (told && context != EGL_NO_CONTEXT && api != EGL_OPENVG_API) {
    note_created({egl, number(display), number(context)}, number(share), api == EGL_OPENGL_API);
    report_gone();
  }
  return context;
}

UNDERSTUDY_ENTRY EGLBoolean eglDestroyContext(EGLDisplay display, EGLContext context) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLContext)> real{egl, "eglDestroyContext"};
  const bool told = concerns_core();
  const ContextKey key{egl, number(display), number(context)};
  if (told) before_destroy(key);
  const EGLBoolean destroyed = real(display, context);
  if (told && destroyed == EGL_TRUE) after_destroy(key);
  return destroyed;
}

UNDERSTUDY_ENTRY EGLBoolean eglMakeCurrent(EGLDisplay display, EGLSurface draw, EGLSurface read,
                                           EGLContext context) {
  return make_current_egl(display, draw, read, context);
}

UNDERSTUDY_ENTRY EGLBoolean eglReleaseThread() {
  static constinit RealFunction<EGLBoolean (*)()> real{egl, "eglReleaseThread"};
  return make_current({egl, 0, 0, 0, 0}, [&] { return real(); });
}

UNDERSTUDY_ENTRY EGLBoolean eglTerminate(EGLDisplay display) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay)> real{egl, "eglTerminate"};
  const bool told = concerns_core();
  const CurrentContext& current = entry_thread.current;
  if (told && current.system == egl && current.display == number(display)) before_frame_end(FrameEnd::destroy);
  const EGLBoolean terminated = real(display);
  if (told && terminated == EGL_TRUE) {
    note_display_closed(egl, number(display));
    report_gone();
  }
  return terminated;
}

UNDERSTUDY_ENTRY EGLBoolean eglSwapBuffers(EGLDisplay display, EGLSurface surface) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface)> real{egl, "eglSwapBuffers"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface); });
}

UNDERSTUDY_ENTRY EGLBoolean eglSwapBuffersWithDamageKHR(EGLDisplay display, EGLSurface surface,
                                                        const EGLint* rects, EGLint count) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, const EGLint*, EGLint)> real{
      egl, "eglSwapBuffersWithDamageKHR"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface, rects, count); });
}

UNDERSTUDY_ENTRY EGLBoolean eglSwapBuffersWithDamageEXT(EGLDisplay display, EGLSurface surface,
                                                        const EGLint* rects, EGLint count) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, const EGLint*, EGLint)> real{
      egl, "eglSwapBuffersWithDamageEXT"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface, rects, count); });
}

UNDERSTUDY_ENTRY EGLBoolean eglPostSubBufferNV(EGLDisplay display, EGLSurface surface, EGLint x, EGLint y,
                                               EGLint width, EGLint height) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, EGLint, EGLint, EGLint, EGLint)> real{
      egl, "eglPostSubBufferNV"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface, x, y, width, height); });
}

UNDERSTUDY_ENTRY EGLBoolean eglSwapBuffersRegionNOK(EGLDisplay display, EGLSurface surface, EGLint count,
                                                    const EGLint* rects) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, EGLint, const EGLint*)> real{
      egl, "eglSwapBuffersRegionNOK"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface, count, rects); });
}

UNDERSTUDY_ENTRY EGLBoolean eglSwapBuffersRegion2NOK(EGLDisplay display, EGLSurface surface, EGLint count,
                                                     const EGLint* rects) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, EGLint, const EGLint*)> real{
      egl, "eglSwapBuffersRegion2NOK"};
  return end_frame(FrameEnd::swap, [&] { return real(display, surface, count, rects); });
}

UNDERSTUDY_ENTRY EGLBoolean eglCopyBuffers(EGLDisplay display, EGLSurface surface, EGLNativePixmapType target) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSurface, EGLNativePixmapType)> real{
      egl, "eglCopyBuffers"};
  return end_frame(FrameEnd::wait, [&] { return real(display, surface, target); });
}

UNDERSTUDY_ENTRY EGLBoolean eglWaitClient() {
  static constinit RealFunction<EGLBoolean (*)()> real{egl, "eglWaitClient"};
  return end_frame(FrameEnd::wait, [&] { return real(); });
}

UNDERSTUDY_ENTRY EGLBoolean eglWaitGL() {
  static constinit RealFunction<EGLBoolean (*)()> real{egl, "eglWaitGL"};
  return end_frame(FrameEnd::wait, [&] { return real(); });
}

// Whoever waits for a fence, or has an image of a texture or renderbuffer, sees what was drawn before: another
// context, thread or process.

UNDERSTUDY_ENTRY EGLSync eglCreateSync(EGLDisplay display, EGLenum type, const EGLAttrib* attributes) {
  static constinit RealFunction<EGLSync (*)(EGLDisplay, EGLenum, const EGLAttrib*)> real{egl, "eglCreateSync"};
  return end_frame(FrameEnd::wait, [&] { return real(display, type, attributes); });
}

UNDERSTUDY_ENTRY EGLSyncKHR eglCreateSyncKHR(EGLDisplay display, EGLenum type, const EGLint* attributes) {
  static constinit RealFunction<EGLSyncKHR (*)(EGLDisplay, EGLenum, const EGLint*)> real{egl,
                                                                                         "eglCreateSyncKHR"};
  return end_frame(FrameEnd::wait, [&] { return real(display, type, attributes); });
}

UNDERSTUDY_ENTRY EGLSyncKHR eglCreateSync64KHR(EGLDisplay display, EGLenum type,
                                               const EGLAttribKHR* attributes) {
  static constinit RealFunction<EGLSyncKHR (*)(EGLDisplay, EGLenum, const EGLAttribKHR*)> real{
      egl, "eglCreateSync64KHR"};
  return end_frame(FrameEnd::wait, [&] { return real(display, type, attributes); });
}

UNDERSTUDY_ENTRY EGLint eglClientWaitSync(EGLDisplay display, EGLSync sync, EGLint flags, EGLTime timeout) {
  static constinit RealFunction<EGLint (*)(EGLDisplay, EGLSync, EGLint, EGLTime)> real{egl,
                                                                                       "eglClientWaitSync"};
  return end_frame(FrameEnd::wait, [&] { return real(display, sync, flags, timeout); });
}

UNDERSTUDY_ENTRY EGLint eglClientWaitSyncKHR(EGLDisplay display, EGLSyncKHR sync, EGLint flags,
                                             EGLTimeKHR timeout) {
  static constinit RealFunction<EGLint (*)(EGLDisplay, EGLSyncKHR, EGLint, EGLTimeKHR)> real{
      egl, "eglClientWaitSyncKHR"};
  return end_frame(FrameEnd::wait, [&] { return real(display, sync, flags, timeout); });
}

UNDERSTUDY_ENTRY EGLBoolean eglWaitSync(EGLDisplay display, EGLSync sync, EGLint flags) {
  static constinit RealFunction<EGLBoolean (*)(EGLDisplay, EGLSync, EGLint)> real{egl, "eglWaitSync"};
  return end_frame(FrameEnd::wait, [&] { return real(display, sync, flags); });
}

UNDERSTUDY_ENTRY EGLint eglWaitSyncKHR(EGLDisplay display, EGLSyncKHR sync, EGLint flags) {
  static constinit RealFunction<EGLint (*)(EGLDisplay, EGLSyncKHR, EGLint)> real{egl, "eglWaitSyncKHR"};
  return end_frame(FrameEnd::wait, [&] { return real(display, sync, flags); });
}

UNDERSTUDY_ENTRY EGLImage eglCreateImage(EGLDisplay display, EGLContext context, EGLenum target,
                                         EGLClientBuffer buffer, const EGLAttrib* attributes) {
  static constinit RealFunction<EGLImage (*)(EGLDisplay, EGLContext, EGLenum, EGLClientBuffer,
                                             const EGLAttrib*)>
      real{egl, "eglCreateImage"};
  return end_frame(FrameEnd::wait, [&] { return real(display, context, target, buffer, attributes); });
}

UNDERSTUDY_ENTRY EGLImageKHR eglCreateImageKHR(EGLDisplay display, EGLContext context, EGLenum target,
                                               EGLClientBuffer buffer, const EGLint* attributes) {
  static constinit RealFunction<EGLImageKHR (*)(EGLDisplay, EGLContext, EGLenum, EGLClientBuffer,
                                                const EGLint*)>
      real{egl, "eglCreateImageKHR"};
  return end_frame(FrameEnd::wait, [&] { return real(display, context, target, buffer, attributes); });
}

UNDERSTUDY_ENTRY VoidFunction eglGetProcAddress(const char* name) {
  void* real = real_proc_address(egl, name);
  if (real == nullptr || entry_thread.level > 0) return reinterpret_cast<VoidFunction>(real);
  const bool ours = std::strncmp(name, "gl", 2) == 0 || std::strncmp(name, "egl", 3) == 0;
  void* own = ours ? own_entry(name) : nullptr;
  return reinterpret_cast<VoidFunction>(own != nullptr ? own : real);
}

// As in glx.cc: no EGL context or surface can be current before EGL's library is open.

UNDERSTUDY_ENTRY EGLContext eglGetCurrentContext() {
  static constinit RealFunction<EGLContext (*)()> real{egl, "eglGetCurrentContext"};
  return driver_is_open(egl) ? real() : EGL_NO_CONTEXT;
}

UNDERSTUDY_ENTRY EGLDisplay eglGetCurrentDisplay() {
  static constinit RealFunction<EGLDisplay (*)()> real{egl, "eglGetCurrentDisplay"};
  return driver_is_open(egl) ? real() : EGL_NO_DISPLAY;
}

UNDERSTUDY_ENTRY EGLSurface eglGetCurrentSurface(EGLint which) {
  static constinit RealFunction<EGLSurface (*)(EGLint)> real{egl, "eglGetCurrentSurface"};
  return driver_is_open(egl) ? real(which) : EGL_NO_SURFACE;
}
