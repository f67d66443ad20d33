// SPDX-License-Identifier: Apache-2.0
// opened LIBRARY FUNCTION: opens the library and calls the function with one argument, 0.
#include <dlfcn.h>
#include <stdio.h>

int main(int, char** arguments) {
  void* library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    puts(dlerror());
    return 3;
  }
  auto function = reinterpret_cast<void (*)(unsigned long)>(dlsym(library, arguments[2]));
  if (function == nullptr) return 4;
  function(0);
  puts("done");
}
