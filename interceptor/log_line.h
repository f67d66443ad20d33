// SPDX-License-Identifier: Apache-2.0
// Lines on stderr as compositor/logging/log.h writes them, without a C++ library.
#pragma once

#include "compositor/logging/level.h"

namespace understudy::interceptor {

/// "understudy: " and the text, as one line, where UNDERSTUDY_LOG lets this level be written. Leaves errno
/// alone.
[[gnu::format(printf, 2, 3)]] void log_line(logging::Level level, const char* format, ...);

}  // namespace understudy::interceptor
