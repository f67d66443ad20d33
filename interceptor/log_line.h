// SPDX-License-Identifier: Apache-2.0
// Writes lines to stderr in the format of compositor/logging/log.h, without a C++ library.
#pragma once

#include "compositor/logging/level.h"

namespace understudy::interceptor {

/// Writes "understudy: " and the text as one line, if UNDERSTUDY_LOG enables this level. Preserves errno.
[[gnu::format(printf, 2, 3)]] void log_line(logging::Level level, const char* format, ...);

}  // namespace understudy::interceptor
