// SPDX-License-Identifier: Apache-2.0
// What GLX, EGL and OSMesa have in common: a context becomes current, a frame ends. Notifies the core around
// the real calls.
#pragma once

#include <cstdint>

#include "interceptor/context_ledger.h"
#include "interceptor/entry_thread.h"
#include "interceptor/open_core.h"

namespace understudy::interceptor {

/// True if the call came from the application and a core is or may still be opened.
inline bool concerns_core() {
  return entry_thread.level == 0 && !core_is_out();
}

/// The arguments of a make-current call; `handle` 0 releases the current context.
struct WantedContext {
  WindowSystem system;
  std::uintptr_t display;
  std::uintptr_t handle;
  std::uintptr_t draw;
  std::uintptr_t read;
  bool desktop_gl_if_new = true;  ///< for a context whose creation was not seen
};

/// Called after a successful make-current: from now on the thread's calls go to that context's OpenGL, or to
/// none. Needed even without a core.
void follow_driver(const WantedContext& wanted);

/// Called before and after a make-current call. `succeeded` false restores the previous state.
void before_make_current(const WantedContext& wanted);
void after_make_current(const WantedContext& wanted, bool succeeded);

template <class RealCall>
auto make_current(const WantedContext& wanted, RealCall real_call) {
  if (!concerns_core()) {
    const auto result = real_call();
    if (result != 0 && entry_thread.level == 0) follow_driver(wanted);
    return result;
  }
  before_make_current(wanted);
  const auto result = real_call();
  after_make_current(wanted, result != 0);
  return result;
}

/// Tells the core that this thread's frame is about to end, or has ended; `window` as in CoreServices. Does
/// nothing without core or context.
void before_frame_end(FrameEnd kind);
void after_frame_end(FrameEnd kind, std::uintptr_t window = 0);

/// Wraps a call that ends or publishes a frame: everything pending is written to the framebuffer before it.
template <class RealCall>
auto end_frame(FrameEnd kind, RealCall real_call, std::uintptr_t window = 0) {
  struct Ended {
    FrameEnd kind;
    std::uintptr_t window;
    ~Ended() { after_frame_end(kind, window); }
  };
  before_frame_end(kind);
  const Ended ended{kind, window};
  return real_call();
}

/// Called around the destruction of a context: if it is this thread's, pending work is finished first.
void before_destroy(const ContextKey& key);
void after_destroy(const ContextKey& key);

/// Tells the core which contexts have been destroyed.
void report_gone();

}  // namespace understudy::interceptor
