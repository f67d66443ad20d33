// SPDX-License-Identifier: Apache-2.0
// The entry library's state of each thread, and the two guards that record whether the thread is running driver
// or core code.
//
// The level is VirtualGL's idea (faker::TempContext and its thread-local "faker level"): while it is above
// zero, a call to one of our exported functions comes from the driver or the core, not from the application,
// and goes to the driver uncounted.
#pragma once

#include <cstdint>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// The thread's current context as the core knows it; `context` is 0 if no context that the entry library
/// tracks is current.
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
  ThreadState state;                     ///< if `table` is set, so is `calls`
  std::uint64_t spare_calls = 0;         ///< counter used if the core has provided none
  std::uint64_t calls_at_frame_end = 0;  ///< of OSMesa (osmesa.cc)
  int level = 0;
  CurrentContext current;
};

// Compiled with -ftls-model=initial-exec: every GL call needs one load relative to the thread pointer, no call.
// Its few dozen bytes fit into the static TLS that glibc reserves for libraries that are opened late.
// NOLINTNEXTLINE(bugprone-dynamic-static-initializers): constinit, which clang-tidy 14 does not see here.
extern constinit thread_local EntryThread entry_thread __attribute__((visibility("hidden")));

/// In scope while the thread runs code of the real driver.
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

/// In scope while the thread runs code of the core, which may change the thread's table.
class InsideCore {
 public:
  InsideCore() { ++entry_thread.level; }
  ~InsideCore() { --entry_thread.level; }
  InsideCore(const InsideCore&) = delete;
  InsideCore& operator=(const InsideCore&) = delete;
};

}  // namespace understudy::interceptor
