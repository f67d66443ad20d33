// SPDX-License-Identifier: Apache-2.0
// Who loads a volume and renders it: nodes of this command, nodes that run already, or this process.
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
  std::string connect;        ///< nodes that run already
  ConnectionPlan connection;  ///< if they are on another machine
  NodeChoices choices;
};

void add_loading_nodes(CLI::App& subcommand, LoadingNodes& arguments);

/// Whether all its ranks run on this machine. Throws std::runtime_error where there can be no nodes.
bool ranks_are_here(const LoadingNodes& arguments);

/// Makes a service that holds no volume yet; again, where the one before was lost. Throws ServiceLost.
using ServiceMaker = std::function<std::unique_ptr<compositor::LoadingService>()>;

/// Runs `job`, with nodes behind it where nodes are asked for. A signal that asks for the end asks the job to
/// stop, where nodes are this command's; elsewhere it ends the process. Returns what the nodes said about who
/// casts their rays. What the job throws is thrown on. Throws std::invalid_argument and std::runtime_error
/// where there can be no nodes.
std::vector<std::string> with_loading_nodes(
    const LoadingNodes& arguments,
    const std::function<void(const ServiceMaker& make, const std::stop_token& stop)>& job);

}  // namespace understudy::launcher
