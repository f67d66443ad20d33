// SPDX-License-Identifier: Apache-2.0
// Runs a job with render nodes that exist for its duration.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/launch/node_choices.h"

namespace understudy::launcher {

struct OwnNodes {
  Placement placement{Launch::this_machine, 1, {}};
  NodeChoices choices;
};

/// Starts the ranks and runs `job` on a separate thread, with the nodes' socket, while this thread
/// supervises the nodes. Returns the backends that the nodes reported. A termination signal ends the nodes
/// and requests the job to stop, so that it fails soon. Rethrows what the job throws. Throws
/// std::runtime_error if no nodes can be started.
std::vector<std::string> with_own_nodes(
    const OwnNodes& own,
    const std::function<void(const std::string& socket, const std::stop_token& stop)>& job);

}  // namespace understudy::launcher
