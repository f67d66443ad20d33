// SPDX-License-Identifier: Apache-2.0
// plugin_host PLUGIN [deep]: opens a plugin, with `deep` by RTLD_DEEPBIND (its own libraries first), and draws.
#include <dlfcn.h>
#include <stdio.h>

int main(int count, char** arguments) {
  void* plugin = dlopen(arguments[1], RTLD_NOW | (count > 2 ? RTLD_DEEPBIND : 0));
  if (plugin == nullptr) {
    puts(dlerror());
    return 3;
  }
  reinterpret_cast<void (*)()>(dlsym(plugin, "draw"))();
  puts("done");
}
