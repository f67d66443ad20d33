// SPDX-License-Identifier: Apache-2.0
// Work on all cores that is abandoned when it takes too long.
#pragma once

#include <functional>

#include "compositor/transport/socket.h"

namespace understudy::compositor {

/// Runs `work` on this thread and on those of its arena. Returns false if it was not done at `until`: tasks
/// that had not begun are then skipped, and those that had are waited for. Rethrows what `work` throws.
bool done_until(Deadline until, const std::function<void()>& work);

}  // namespace understudy::compositor
