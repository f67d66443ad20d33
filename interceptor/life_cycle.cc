// SPDX-License-Identifier: Apache-2.0
#include "interceptor/life_cycle.h"

#include <pthread.h>

#include "interceptor/real_driver.h"

namespace understudy::interceptor {
namespace {

/// Lets the core set the thread's table for a context that is current on the driver.
void enter(const CoreServices& services, const KnownContext& known, const CurrentContext& current) {
  EntryThread& thread = entry_thread;
  if (thread.state.calls == nullptr) thread.state.calls = &thread.spare_calls;
  const InsideCore inside;
  services.context_current(known.context, known.share, current.system, known.desktop_gl, current.draw);
  if (thread.state.table == nullptr) thread.state.table = thread.state.driver;
  if (thread.state.calls == nullptr) thread.state.calls = &thread.spare_calls;
}

bool same_attachment(const WantedContext& wanted, const CurrentContext& current) {
  return current.context != 0 && wanted.system == current.system && wanted.handle == current.handle &&
         wanted.draw == current.draw && wanted.read == current.read;
}

/// Releasing (handle 0) only affects a context of the same window system.
bool touches_current(const WantedContext& wanted, const CurrentContext& current) {
  return current.context != 0 && (wanted.handle != 0 || wanted.system == current.system);
}

/// Releases the context of a thread that ends. The driver may already have released its state of the thread, so
/// no call is made for it, and whatever the thread still calls bypasses the core.
void thread_ends(void*) {
  EntryThread& thread = entry_thread;
  thread.state.table = nullptr;
  if (thread.current.context == 0) return;
  note_not_current(thread.current.context);
  thread.current = {};
  report_gone();
}

void watch_end_of_thread() {
  static constinit pthread_key_t key;
  static constinit pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, [] { pthread_key_create(&key, &thread_ends); });
  pthread_setspecific(key, &entry_thread);  // any value but null makes pthread call thread_ends
}

}  // namespace

void follow_driver(const WantedContext& wanted) {
  ThreadState& state = entry_thread.state;
  if (wanted.handle == 0 && state.driver == nullptr) return;
  const spu::DispatchTable& driver = driver_table(wanted.system);
  if (wanted.handle == 0 && state.driver != &driver) return;  // another window system's context stays current
  state.driver = wanted.handle != 0 ? &driver : nullptr;
  state.table = nullptr;
}

void before_make_current(const WantedContext& wanted) {
  EntryThread& thread = entry_thread;
  const CoreServices* services = core();
  if (services == nullptr || !touches_current(wanted, thread.current)) return;
  const InsideCore inside;
  services->before_frame_end(FrameEnd::make_current);
  if (!same_attachment(wanted, thread.current)) services->context_leaving();
}

void after_make_current(const WantedContext& wanted, bool succeeded) {
  EntryThread& thread = entry_thread;
  const bool same = same_attachment(wanted, thread.current);
  if (!succeeded) {
    // The old context is still current: the core, which was told that it is leaving, enters it again.
    const CoreServices* services = core();
    if (services != nullptr && !same && touches_current(wanted, thread.current)) {
      enter(*services, known_context(thread.current.context), thread.current);
    }
    return;
  }
  if (same) return;
  if (wanted.handle == 0 && !touches_current(wanted, thread.current)) return;

  if (thread.current.context != 0) note_not_current(thread.current.context);
  thread.current = {};
  follow_driver(wanted);
  if (wanted.handle != 0) {
    if (const CoreServices* services = open_core()) {
      const KnownContext known =
          note_current({wanted.system, wanted.display, wanted.handle}, wanted.desktop_gl_if_new);
      if (known.context != 0) {
        thread.current = {known.context, wanted.system, wanted.display,
                          wanted.handle, wanted.draw,   wanted.read};
        watch_end_of_thread();
        enter(*services, known, thread.current);
      }
    }
  }
  report_gone();
}

void before_frame_end(FrameEnd kind) {
  const CoreServices* services = core();
  if (services == nullptr || entry_thread.level > 0 || entry_thread.current.context == 0) return;
  const InsideCore inside;
  services->before_frame_end(kind);
}

void after_frame_end(FrameEnd kind, std::uintptr_t window) {
  const CoreServices* services = core();
  if (services == nullptr || entry_thread.level > 0 || entry_thread.current.context == 0) return;
  const InsideCore inside;
  services->after_frame_end(kind, window);
}

void before_destroy(const ContextKey& key) {
  const CurrentContext& current = entry_thread.current;
  if (current.context != 0 && current.system == key.system && current.handle == key.handle) {
    before_frame_end(FrameEnd::destroy);
  }
}

void after_destroy(const ContextKey& key) {
  note_destroyed(key);
  report_gone();
}

void report_gone() {
  const CoreServices* services = core();
  if (services == nullptr) return;
  while (const std::uintptr_t context = next_gone()) {
    const InsideCore inside;
    services->context_destroyed(context);
  }
}

}  // namespace understudy::interceptor
