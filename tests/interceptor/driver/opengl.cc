// SPDX-License-Identifier: Apache-2.0
// libOpenGL.so.0 of the test driver. It lacks glAccum, to test missing functions.
#include "driver.h"

DRIVER_FUNCTION void glClear(unsigned) {
  say("driver: glClear\n");
}
DRIVER_FUNCTION void glFlush() {
  say("driver: glFlush\n");
}
