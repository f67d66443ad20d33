// SPDX-License-Identifier: Apache-2.0
// A plugin linked with libGL.
extern "C" void glClear(unsigned mask);
extern "C" __attribute__((visibility("default"))) void draw() {
  glClear(0x4000);
}
