// SPDX-License-Identifier: Apache-2.0
// Linked with libOSMesa.
#include <stdio.h>

extern "C" void* OSMesaCreateContext(unsigned format, void* share);

int main() {
  OSMesaCreateContext(0x1908, nullptr);
  puts("done");
}
