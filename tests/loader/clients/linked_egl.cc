// SPDX-License-Identifier: Apache-2.0
// Linked with libEGL.
#include <stdio.h>

extern "C" void* eglGetDisplay(void* native);

int main() {
  eglGetDisplay(nullptr);
  puts("done");
}
