// SPDX-License-Identifier: Apache-2.0
// A program that never uses OpenGL, but opens another library; prints the mapped files.
#include <dlfcn.h>
#include <stdio.h>

int main() {
  dlopen("libz.so.1", RTLD_NOW);
  FILE* maps = fopen("/proc/self/maps", "r");
  for (int c; maps != nullptr && (c = getc(maps)) != EOF;) putchar(c);
  puts("done");
}
