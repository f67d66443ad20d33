// SPDX-License-Identifier: Apache-2.0
// Counts calls of a process that never has a context. No core is opened for it, so the entry library itself
// writes the count for the launcher's report.
#pragma once

namespace understudy::interceptor {

/// Counts a call of GLX or EGL by the application.
void count_window_system_call();

}  // namespace understudy::interceptor
