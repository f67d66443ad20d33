// SPDX-License-Identifier: Apache-2.0
// Work on all cores that is given up when it takes too long.
#pragma once

#include <functional>

#include "compositor/transport/socket.h"

namespace understudy::compositor {

/// Runs `work` on this thread and on those of its arena. False when it was not done at `until`: tasks that had
/// not begun then are left out, those that had are waited for. What `work` throws is thrown on.
bool done_until(Deadline until, const std::function<void()>& work);

}  // namespace understudy::compositor
