// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>

extern "C" void draw();

int main() {
  draw();
  puts("done");
}
