// SPDX-License-Identifier: Apache-2.0
// Functions and data of libraries that are opened when first needed, by name.
#pragma once

#include <dlfcn.h>

namespace understudy::interceptor {

/// Whether the library has something of that name; null is left in `found` where it has not.
template <class Pointer>
bool find_in_library(void* library, const char* name, Pointer& found) {
  found = reinterpret_cast<Pointer>(dlsym(library, name));
  return found != nullptr;
}

}  // namespace understudy::interceptor
