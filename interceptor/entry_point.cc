// SPDX-License-Identifier: Apache-2.0
#include "interceptor/entry_point.h"

#include <stdio.h>
#include <unistd.h>

#include <atomic>

#include "interceptor/log_line.h"
#include "interceptor/open_core.h"
#include "interceptor/real_driver.h"
#include "interceptor/remote.h"

namespace understudy::interceptor {

namespace {

/// The driver's functions for this thread's current context, or the contextless table.
const spu::DispatchTable& real_functions() {
  const spu::DispatchTable* driver = entry_thread.state.driver;
  return driver != nullptr ? *driver : driver_table_without_context();
}

}  // namespace

const spu::DispatchTable& enter_without_context() {
  EntryThread& thread = entry_thread;
  if (thread.level == 0) {
    if (thread.state.calls != nullptr) ++*thread.state.calls;
    // No core will ever need this thread's calls: its next calls take the fast path.
    if (core_is_out()) {
      thread.state.table = &real_functions();
      thread.state.calls = &thread.spare_calls;
    }
  }
  return real_functions();
}

void report_missing(const char* name) {
  // With remote OpenGL, calls without a context do nothing, and unsupported functions are not announced.
  if (is_remote()) return;
  static constinit std::atomic_flag said{};
  if (said.test_and_set()) return;
  log_line(logging::Level::warn,
           "the application calls %s, which this OpenGL driver lacks; such calls do nothing", name);
}

}  // namespace understudy::interceptor
