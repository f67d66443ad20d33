// SPDX-License-Identifier: Apache-2.0
// Opens EGL and queries its driver; prints whether the kernel treats this process as more privileged than its
// user (AT_SECURE).
#include <dlfcn.h>
#include <sys/auxv.h>

#include <cstdio>

int main() {
  std::printf("secure %lu\n", getauxval(AT_SECURE));
  void* const library = dlopen(ENTRY_LIBRARY, RTLD_NOW);
  if (library == nullptr) {
    std::printf("%s\n", dlerror());
    return 1;
  }
  using GetDisplay = void* (*)(void*);
  const auto get_display = reinterpret_cast<GetDisplay>(dlsym(library, "eglGetDisplay"));
  if (get_display == nullptr) return 1;
  get_display(nullptr);
  return 0;
}
