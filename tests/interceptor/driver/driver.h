// SPDX-License-Identifier: Apache-2.0
// A driver for tests: draws nothing, and prints every call as one line on standard output.
#pragma once

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

#define DRIVER_FUNCTION extern "C" __attribute__((visibility("default")))

/// One write per line, so that the lines of driver, core library and application appear in the order of the
/// calls.
__attribute__((format(printf, 1, 2))) inline void say(const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (length > 0 && write(STDOUT_FILENO, line, static_cast<size_t>(length)) < 0) _exit(3);
}

/// Context handles 1, 2, 3..., the lowest free one first: handles are reused, as addresses are.
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

/// A drawable with which no context can be made current.
constexpr unsigned long bad_drawable = 13;
