// SPDX-License-Identifier: Apache-2.0
// Selects what loads and renders a volume: nodes of this command, nodes that run already, or this process.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "apps/understudy/launch/node_choices.h"
#include "apps/understudy/launch/relay.h"
#include "compositor/service/loading_service.h"

namespace understudy::launcher {

struct LoadingNodes {
  std::optional<int> nodes;
  std::filesystem::path hostfile;
  std::string connect;        ///< where nodes run already: a socket, or HOST:PORT
  ConnectionPlan connection;  ///< for nodes on another machine
  NodeChoices choices;
};

void add_loading_nodes(CLI::App& subcommand, LoadingNodes& arguments);

/// Returns whether all ranks run on this machine. Throws std::runtime_error if there can be no nodes.
bool ranks_are_here(const LoadingNodes& arguments);

/// Makes a service without volumes; also after the previous one was lost. Throws ServiceLost.
using ServiceMaker = std::function<std::unique_ptr<compositor::LoadingService>()>;

/// Runs `job`, on nodes if `arguments` ask for them. If the nodes are this command's own, a
/// termination signal requests the job to stop; otherwise it ends the process. Returns the backends
/// that the nodes reported. Rethrows what the job throws. Throws std::invalid_argument and
/// std::runtime_error if there can be no nodes.
std::vector<std::string> with_loading_nodes(
    const LoadingNodes& arguments,
    const std::function<void(const ServiceMaker& make, const std::stop_token& stop)>& job);

}  // namespace understudy::launcher
