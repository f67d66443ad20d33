// The gate of `understudy serve --listen`: a process that lets clients of other machines in, if they have the
// secret, and gives each a process that carries its messages to the nodes or to the stage here
// (compositor/tcp).
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>

#include "apps/understudy/child_process.h"
#include "apps/understudy/installation.h"
#include "compositor/tcp/address.h"

namespace understudy::launcher {

struct GatePlan {
  compositor::TcpAddress address;
  std::filesystem::path secret_file;
  std::filesystem::path nodes;   ///< the nodes' socket
  std::filesystem::path stage;   ///< the stage's; empty: none is offered
  std::filesystem::path folder;  ///< private; must exist
};

struct OpenGate {
  std::unique_ptr<ChildProcess> process;
  compositor::TcpAddress address;  ///< with the port that was taken, if any would do
};

/// Returns once it listens. Throws std::runtime_error when it does not; why, it has said itself.
OpenGate start_gate(const Installation& installation, const GatePlan& plan);

/// Adds the subcommand `gate`, which is not shown in the help.
void add_gate(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
