// SPDX-License-Identifier: Apache-2.0
// Opens OSMesa, and gets the other functions from OSMesaGetProcAddress.
#include <dlfcn.h>
#include <stdio.h>

int main() {
  void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return 3;
  const auto address = reinterpret_cast<void* (*)(const char*)>(dlsym(library, "OSMesaGetProcAddress"));
  if (address == nullptr) return 4;
  const auto create = reinterpret_cast<void* (*)(unsigned, void*)>(address("OSMesaCreateContext"));
  if (create == nullptr) return 5;
  create(0x1908, nullptr);
  puts("done");
}
