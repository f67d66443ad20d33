// SPDX-License-Identifier: Apache-2.0
// What every exported gl* function does before it forwards the call (the functions themselves are generated).
#pragma once

#include "dispatch/call_id.h"
#include "interceptor/entry_thread.h"

#define UNDERSTUDY_ENTRY extern "C" __attribute__((visibility("default")))

namespace understudy::interceptor {

/// The table for threads without a context, for calls that the driver makes, and for a thread's first call.
const spu::DispatchTable& enter_without_context();

/// Counts the call and returns the table that it is forwarded to.
inline const spu::DispatchTable& entered_table() {
  ThreadState& state = entry_thread.state;
  if (state.table != nullptr) [[likely]] {
    ++*state.calls;
    return *state.table;
  }
  return enter_without_context();
}

/// Warns once that the driver lacks a function that the application called.
void report_missing(const char* name);

/// Replaces a function that the driver lacks: does nothing and returns zero.
template <class Result>
Result missing(spu::CallId call) {
  report_missing(spu::call_name(call));
  return Result();
}

}  // namespace understudy::interceptor
