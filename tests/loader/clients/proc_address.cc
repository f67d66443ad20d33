// SPDX-License-Identifier: Apache-2.0
// Linked with libGL, but gets glClear from glXGetProcAddressARB, as every extension loader does.
#include <stdio.h>

extern "C" void (*glXGetProcAddressARB(const unsigned char* name))();

int main() {
  auto clear = reinterpret_cast<void (*)(unsigned)>(
      glXGetProcAddressARB(reinterpret_cast<const unsigned char*>("glClear")));
  if (clear == nullptr) return 4;
  clear(0x4000);
  puts("done");
}
