// SPDX-License-Identifier: Apache-2.0
// names [LIBRARY...]: opens the libraries in that order, prints for each the file that a function of it comes
// from, and calls the function, so that the driver is loaded. Built with no library, and with each of them.
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#ifdef LINKED_FUNCTION
extern "C" void* LINKED_FUNCTION(void*);
#endif

namespace {

const char* function_of(const char* library) {
  if (strncmp(library, "libEGL", 6) == 0) return "eglGetDisplay";
  if (strncmp(library, "libGLX", 6) == 0) return "glXGetCurrentContext";
  return "glClear";
}

}  // namespace

int main(int count, char** arguments) {
#ifdef LINKED_FUNCTION
  LINKED_FUNCTION(nullptr);
#endif
  for (int i = 1; i < count; ++i) {
    void* library = dlopen(arguments[i], RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      puts(dlerror());
      return 3;
    }
    void* function = dlsym(library, function_of(arguments[i]));
    Dl_info info;
    if (function == nullptr || dladdr(function, &info) == 0) return 4;
    printf("%s from %s\n", arguments[i], info.dli_fname);
    reinterpret_cast<void* (*)(void*)>(function)(nullptr);
  }
  puts("done");
}
