// A job that has render nodes for as long as it takes.
#pragma once

#include <functional>
#include <string>

namespace understudy::launcher {

/// Starts `nodes` ranks and runs `job` on a thread of its own, with the nodes' socket, while this thread looks
/// after them. A signal that asks for the end takes the nodes away, so that the job fails soon. What the job
/// throws is thrown on. Throws std::runtime_error where no nodes can be started.
void with_own_nodes(int nodes, const std::function<void(const std::string& socket)>& job);

}  // namespace understudy::launcher
