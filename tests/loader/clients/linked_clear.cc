// SPDX-License-Identifier: Apache-2.0
// Linked with the library that the build selects; calls glClear.
#include <stdio.h>

extern "C" void glClear(unsigned mask);

int main() {
  glClear(0x4000);
  puts("done");
}
