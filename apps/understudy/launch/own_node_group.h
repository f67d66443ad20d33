// SPDX-License-Identifier: Apache-2.0
// A job that has render nodes for as long as it takes.
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

/// Starts the ranks and runs `job` on a thread of its own, with the nodes' socket, while this thread looks
/// after them. Returns what the nodes said about who casts their rays. A signal that asks for the end takes the
/// nodes away and asks the job to stop, so that it fails soon. What the job throws is thrown on. Throws
/// std::runtime_error where no nodes can be started.
std::vector<std::string> with_own_nodes(
    const OwnNodes& own,
    const std::function<void(const std::string& socket, const std::stop_token& stop)>& job);

}  // namespace understudy::launcher
