// SPDX-License-Identifier: Apache-2.0
#include "interceptor/log_line.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

namespace understudy::interceptor {

void log_line(logging::Level level, const char* format, ...) {
  if (level < logging::lowest_level()) return;
  const int error_before = errno;
  char text[4096];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  dprintf(STDERR_FILENO, "understudy: %s%s\n", level == logging::Level::debug ? "debug: " : "", text);
  errno = error_before;
}

}  // namespace understudy::interceptor
