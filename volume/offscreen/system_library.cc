// SPDX-License-Identifier: Apache-2.0
#include "volume/offscreen/system_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

namespace understudy::volume::offscreen {

SystemLibrary::SystemLibrary(std::initializer_list<const char*> names, const char* packages) {
  std::string errors;
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    name_ = name;
    if (handle_ != nullptr) return;
    errors += fmt::format("{}{}", errors.empty() ? "" : ", ", dlerror());
  }
  throw ContextUnavailable(fmt::format("{}; install {}", errors, packages));
}

void* SystemLibrary::address(const char* name, const char* version) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr) throw ContextUnavailable(fmt::format("{} has no {}; install {}", name_, name, version));
  return found;
}

}  // namespace understudy::volume::offscreen
