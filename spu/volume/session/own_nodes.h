// SPDX-License-Identifier: Apache-2.0
// Starts nodes for a process that was started without the launcher: UNDERSTUDY_NODES=4 with plain LD_PRELOAD.
#pragma once

#include <string>

namespace understudy::spu {

/// Starts `understudy serve` beside this process, on the socket that is returned; it exits when this process
/// has exited. Empty, with the reason on stderr, if it cannot be started. Waits a few seconds at most.
std::string start_own_nodes(int nodes);

}  // namespace understudy::spu
