// SPDX-License-Identifier: Apache-2.0
// osmesa_opened LIBRARY dlsym|address: opens OSMesa and looks up functions with dlsym or OSMesaGetProcAddress.
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include <vector>

namespace {

void* library;
bool by_address;

template <class Function>
Function get(const char* name) {
  void* function = dlsym(library, name);
  if (by_address) {
    const auto address =
        reinterpret_cast<decltype(&OSMesaGetProcAddress)>(dlsym(library, "OSMesaGetProcAddress"));
    function = reinterpret_cast<void*>(address(name));
  }
  if (function == nullptr) printf("no %s\n", name);
  return reinterpret_cast<Function>(function);
}
#define GET(name) get<decltype(&name)>(#name)

}  // namespace

int main(int, char** arguments) {
  library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    puts("cannot be opened");
    return 0;
  }
  by_address = strcmp(arguments[2], "address") == 0;
  constexpr int size = 16;
  std::vector<unsigned char> array(std::size_t{4} * size * size);
  const OSMesaContext context = GET(OSMesaCreateContext)(OSMESA_RGBA, nullptr);
  if (!GET(OSMesaMakeCurrent)(context, array.data(), GL_UNSIGNED_BYTE, size, size)) return 3;
  GET(glClearColor)(1, 0.5F, 0.25F, 1);
  GET(glClear)(GL_COLOR_BUFFER_BIT);
  GET(glFinish)();
  printf("%s: %d %d %d %d\n", reinterpret_cast<const char*>(GET(glGetString)(GL_VERSION)), array[0], array[1],
         array[2], array[3]);
  GET(OSMesaDestroyContext)(context);
}
