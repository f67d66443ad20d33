// SPDX-License-Identifier: Apache-2.0
// Calls of a process that never has a context: no core is opened for it, so the entry library itself leaves
// their number for the launcher's report.
#pragma once

namespace understudy::interceptor {

/// The application called GLX or EGL.
void count_window_system_call();

}  // namespace understudy::interceptor
