// SPDX-License-Identifier: Apache-2.0
// One function of the real GLX or EGL, looked up when it is first called.
#pragma once

#include <atomic>

#include "interceptor/contextless_calls.h"
#include "interceptor/entry_point.h"
#include "interceptor/entry_thread.h"
#include "interceptor/real_driver.h"

namespace understudy::interceptor {

template <class Function>
class RealFunction;

/// Calls the real function with the thread marked as inside the driver. If the driver lacks the function, warns
/// once, does nothing and returns zero.
template <class Result, class... Arguments>
class RealFunction<Result (*)(Arguments...)> {
 public:
  constexpr RealFunction(WindowSystem system, const char* name) : system_(system), name_(name) {}

  Result operator()(Arguments... arguments) {
    void* function = function_.load(std::memory_order_relaxed);
    if (function == nullptr) {
      function = real_symbol(system_, name_);
      if (function == nullptr) {
        report_missing(name_);
        return Result();
      }
      function_.store(function, std::memory_order_relaxed);
    }
    if (entry_thread.level == 0) count_window_system_call();
    const InsideDriver inside;
    return reinterpret_cast<Result (*)(Arguments...)>(function)(arguments...);
  }

 private:
  WindowSystem system_;
  const char* name_;
  std::atomic<void*> function_ = nullptr;
};

}  // namespace understudy::interceptor
