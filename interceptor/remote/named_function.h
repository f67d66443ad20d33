// SPDX-License-Identifier: Apache-2.0
// Looks up functions by the names under which applications request them.
#pragma once

#include <string.h>

#include <cstddef>

namespace understudy::interceptor {

using AnyRemoteFunction = void (*)();

struct NamedFunction {
  const char* name;
  AnyRemoteFunction function;
};

/// Returns null if no function has that name.
template <std::size_t count>
void* find_function(const NamedFunction (&functions)[count], const char* name) {
  for (const NamedFunction& function : functions) {
    if (strcmp(function.name, name) == 0) return reinterpret_cast<void*>(function.function);
  }
  return nullptr;
}

}  // namespace understudy::interceptor
