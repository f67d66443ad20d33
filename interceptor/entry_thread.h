// SPDX-License-Identifier: Apache-2.0
// What the entry library keeps for each thread, and the two guards that say on whose behalf the thread is
// running.
//
// The level is VirtualGL's idea (faker::TempContext and its thread-local "faker level"): while it is above
// zero, what arrives at our exported names was called by the driver or by the core, not by the application, and
// goes to the driver uncounted.
#pragma once

#include <cstdint>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// Which context the thread has current as far as the core knows; `context` is 0 when none that the entry
/// library follows.
struct CurrentContext {
  std::uintptr_t context = 0;  ///< the entry library's number for it (context_ledger.h)
  WindowSystem system = WindowSystem::glx;
  std::uintptr_t display = 0;
  std::uintptr_t handle = 0;  ///< GLXContext, EGLContext or OSMesaContext
  std::uintptr_t draw = 0;
  std::uintptr_t read = 0;
  bool operator==(const CurrentContext&) const = default;
};

/// One for each thread, initialised at compile time.
struct EntryThread {
  ThreadState state;                     ///< `table` set means `calls` set
  std::uint64_t spare_calls = 0;         ///< counts where the core has given no counter
  std::uint64_t calls_at_frame_end = 0;  ///< of OSMesa (osmesa.cc)
  int level = 0;
  CurrentContext current;
};

// Compiled with -ftls-model=initial-exec: one load relative to the thread pointer, no call, on every GL call.
// Its few dozen bytes fit into the room that glibc keeps for libraries that are opened late.
// NOLINTNEXTLINE(bugprone-dynamic-static-initializers): constinit, which clang-tidy 14 does not see here.
extern constinit thread_local EntryThread entry_thread __attribute__((visibility("hidden")));

/// In scope while the thread is within the real driver.
class InsideDriver {
 public:
  InsideDriver() : table_(entry_thread.state.table) {
    entry_thread.state.table = nullptr;
    ++entry_thread.level;
  }
  ~InsideDriver() {
    --entry_thread.level;
    entry_thread.state.table = table_;
  }
  InsideDriver(const InsideDriver&) = delete;
  InsideDriver& operator=(const InsideDriver&) = delete;

 private:
  const spu::DispatchTable* table_;
};

/// In scope while the thread is within the core, which may change the thread's table.
class InsideCore {
 public:
  InsideCore() { ++entry_thread.level; }
  ~InsideCore() { --entry_thread.level; }
  InsideCore(const InsideCore&) = delete;
  InsideCore& operator=(const InsideCore&) = delete;
};

}  // namespace understudy::interceptor
