// SPDX-License-Identifier: Apache-2.0
#include "interceptor/osmesa.h"

#include <GL/osmesa.h>

#include <cstring>

#include "interceptor/life_cycle.h"
#include "interceptor/real_function.h"

namespace understudy::interceptor {
namespace {

constexpr WindowSystem osmesa = WindowSystem::osmesa;

std::uintptr_t number(const void* handle) {
  return reinterpret_cast<std::uintptr_t>(handle);
}

using Call = void (*)();
constinit Call real_finish = nullptr;
constinit Call real_flush = nullptr;

/// A glFlush followed by a glFinish ends one frame, not two: another call must have been made in between.
void frame_ended(std::uint64_t calls_of_this_end) {
  EntryThread& thread = entry_thread;
  if (thread.level > 0 || thread.current.context == 0) return;
  const std::uint64_t calls = *thread.state.calls;
  const bool drew = calls > thread.calls_at_frame_end + calls_of_this_end;
  thread.calls_at_frame_end = calls;
  if (drew) after_frame_end(FrameEnd::finish);
}

void finish() {
  real_finish();
  frame_ended(1);
}

void flush() {
  real_flush();
  frame_ended(1);
}

/// OSMesa has no read drawable: this value takes its place and distinguishes two shapes of one array.
std::uintptr_t shape(GLenum type, GLsizei width, GLsizei height) {
  return (static_cast<std::uintptr_t>(width) << 40) ^ (static_cast<std::uintptr_t>(height) << 16) ^ type;
}

OSMesaContext created(OSMesaContext context, OSMesaContext share) {
  if (context != nullptr && concerns_core()) {
    note_created({osmesa, 0, number(context)}, number(share), /*desktop_gl=*/true);
    report_gone();
  }
  return context;
}

/// True if the core knows this thread's context, and OSMesa created it.
bool has_current() {
  return concerns_core() && entry_thread.current.system == osmesa && entry_thread.current.context != 0;
}

/// The application is about to get the address of a buffer: everything pending must be in it. No GL call is
/// made for that, which could raise an error in the application's context.
void settle_for_reading() {
  if (has_current()) before_frame_end(FrameEnd::finish);
}

/// The frame of a context ends when the context stops being current.
void end_frame_of_current() {
  if (!has_current()) return;
  before_frame_end(FrameEnd::finish);
  frame_ended(0);
}

}  // namespace

void end_frames_of_osmesa(spu::DispatchTable& functions) {
  if (functions.Finish == &finish || functions.Finish == nullptr || functions.Flush == nullptr) return;
  real_finish = functions.Finish;
  real_flush = functions.Flush;
  functions.Finish = &finish;
  functions.Flush = &flush;
}

}  // namespace understudy::interceptor

using namespace understudy::interceptor;

UNDERSTUDY_ENTRY OSMesaContext OSMesaCreateContext(GLenum format, OSMesaContext share) {
  static constinit RealFunction<OSMesaContext (*)(GLenum, OSMesaContext)> real{osmesa, "OSMesaCreateContext"};
  return created(real(format, share), share);
}

UNDERSTUDY_ENTRY OSMesaContext OSMesaCreateContextExt(GLenum format, GLint depth_bits, GLint stencil_bits,
                                                      GLint accumulation_bits, OSMesaContext share) {
  static constinit RealFunction<OSMesaContext (*)(GLenum, GLint, GLint, GLint, OSMesaContext)> real{
      osmesa, "OSMesaCreateContextExt"};
  return created(real(format, depth_bits, stencil_bits, accumulation_bits, share), share);
}

UNDERSTUDY_ENTRY OSMesaContext OSMesaCreateContextAttribs(const int* attributes, OSMesaContext share) {
  static constinit RealFunction<OSMesaContext (*)(const int*, OSMesaContext)> real{
      osmesa, "OSMesaCreateContextAttribs"};
  return created(real(attributes, share), share);
}

UNDERSTUDY_ENTRY void OSMesaDestroyContext(OSMesaContext context) {
  static constinit RealFunction<void (*)(OSMesaContext)> real{osmesa, "OSMesaDestroyContext"};
  const auto destroy = [&] {
    real(context);
    return true;
  };
  const bool told = concerns_core();
  // GLX and EGL keep a current context until it is released. OSMesa releases it and frees it at once.
  if (has_current() && entry_thread.current.handle == number(context)) {
    end_frame_of_current();
    make_current({osmesa, 0, 0, 0, 0}, destroy);
  } else {
    destroy();
  }
  if (told) after_destroy({osmesa, 0, number(context)});
}

UNDERSTUDY_ENTRY GLboolean OSMesaMakeCurrent(OSMesaContext context, void* buffer, GLenum type, GLsizei width,
                                             GLsizei height) {
  static constinit RealFunction<GLboolean (*)(OSMesaContext, void*, GLenum, GLsizei, GLsizei)> real{
      osmesa, "OSMesaMakeCurrent"};
  // A null context or a null array releases the current context.
  const bool release = context == nullptr || buffer == nullptr;
  const std::uintptr_t drawable = release ? 0 : number(buffer);
  const WantedContext wanted{osmesa, 0, release ? 0 : number(context), drawable,
                             release ? 0 : shape(type, width, height)};
  end_frame_of_current();
  return make_current(wanted, [&] { return real(context, buffer, type, width, height); });
}

UNDERSTUDY_ENTRY OSMesaContext OSMesaGetCurrentContext() {
  static constinit RealFunction<OSMesaContext (*)()> real{osmesa, "OSMesaGetCurrentContext"};
  return driver_is_open(osmesa) ? real() : nullptr;
}

UNDERSTUDY_ENTRY OSMESAproc OSMesaGetProcAddress(const char* name) {
  void* real = real_proc_address(osmesa, name);
  if (real == nullptr || entry_thread.level > 0) return reinterpret_cast<OSMESAproc>(real);
  const bool ours = std::strncmp(name, "gl", 2) == 0 || std::strncmp(name, "OSMesa", 6) == 0;
  void* own = ours ? own_entry(name) : nullptr;
  return reinterpret_cast<OSMESAproc>(own != nullptr ? own : real);
}

UNDERSTUDY_ENTRY GLboolean OSMesaGetDepthBuffer(OSMesaContext context, GLint* width, GLint* height,
                                                GLint* bytes_per_value, void** buffer) {
  static constinit RealFunction<GLboolean (*)(OSMesaContext, GLint*, GLint*, GLint*, void**)> real{
      osmesa, "OSMesaGetDepthBuffer"};
  settle_for_reading();
  return real(context, width, height, bytes_per_value, buffer);
}

UNDERSTUDY_ENTRY GLboolean OSMesaGetColorBuffer(OSMesaContext context, GLint* width, GLint* height,
                                                GLint* format, void** buffer) {
  static constinit RealFunction<GLboolean (*)(OSMesaContext, GLint*, GLint*, GLint*, void**)> real{
      osmesa, "OSMesaGetColorBuffer"};
  settle_for_reading();
  return real(context, width, height, format, buffer);
}

UNDERSTUDY_ENTRY void OSMesaPixelStore(GLint name, GLint value) {
  static constinit RealFunction<void (*)(GLint, GLint)> real{osmesa, "OSMesaPixelStore"};
  real(name, value);
}

UNDERSTUDY_ENTRY void OSMesaGetIntegerv(GLint name, GLint* value) {
  static constinit RealFunction<void (*)(GLint, GLint*)> real{osmesa, "OSMesaGetIntegerv"};
  real(name, value);
}

UNDERSTUDY_ENTRY void OSMesaColorClamp(GLboolean enable) {
  static constinit RealFunction<void (*)(GLboolean)> real{osmesa, "OSMesaColorClamp"};
  real(enable);
}

UNDERSTUDY_ENTRY void OSMesaPostprocess(OSMesaContext context, const char* filter, unsigned enable) {
  static constinit RealFunction<void (*)(OSMesaContext, const char*, unsigned)> real{osmesa,
                                                                                     "OSMesaPostprocess"};
  real(context, filter, enable);
}
