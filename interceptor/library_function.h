// SPDX-License-Identifier: Apache-2.0
// Looks up functions and data by name in libraries that are opened when first needed.
#pragma once

#include <dlfcn.h>

namespace understudy::interceptor {

/// Stores the address of `name` in `found`; returns false and stores null if the library has no such symbol.
template <class Pointer>
bool find_in_library(void* library, const char* name, Pointer& found) {
  found = reinterpret_cast<Pointer>(dlsym(library, name));
  return found != nullptr;
}

}  // namespace understudy::interceptor
