// SPDX-License-Identifier: Apache-2.0
// A driver for tests: it draws nothing and says what it is asked to do, one line a call on standard output.
#pragma once

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

#define DRIVER_FUNCTION extern "C" __attribute__((visibility("default")))

/// One write a line, so that the lines of the driver, the core and the application come in their true order.
__attribute__((format(printf, 1, 2))) inline void say(const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (length > 0 && write(STDOUT_FILENO, line, static_cast<size_t>(length)) < 0) _exit(3);
}

/// Context handles 1, 2, 3…, the lowest free one first: handles come again, as addresses do.
struct Handles {
  static constexpr int size = 16;
  bool taken[size] = {};
  long take() {
    for (int i = 1; i < size; ++i) {
      if (!taken[i]) {
        taken[i] = true;
        return i;
      }
    }
    return 0;
  }
  void give_back(long handle) {
    if (handle > 0 && handle < size) taken[handle] = false;
  }
};

/// A drawable that no context can be made current with.
constexpr unsigned long bad_drawable = 13;
