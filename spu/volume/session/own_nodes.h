// SPDX-License-Identifier: Apache-2.0
// Render nodes for a process that was started without the launcher: UNDERSTUDY_NODES=4 with plain LD_PRELOAD.
#pragma once

#include <string>

namespace understudy::spu {

/// Starts `understudy serve` beside this process, on the socket that is returned; it ends by itself when this
/// process has ended. Empty, with the reason on stderr, when it cannot be started. Waits a few seconds at most.
std::string start_own_nodes(int nodes);

}  // namespace understudy::spu
