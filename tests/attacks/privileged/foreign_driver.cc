// SPDX-License-Identifier: Apache-2.0
// A driver that reports that it was loaded.
#include <cstdio>

[[gnu::constructor]] static void loaded() {
  std::printf("foreign code runs\n");
  std::fflush(stdout);
}
