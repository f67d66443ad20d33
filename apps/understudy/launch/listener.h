// SPDX-License-Identifier: Apache-2.0
// The listener of `understudy serve --listen`: a process that lets clients of other machines in, if they have
// the secret, and gives each a process that carries its messages to the nodes or to the GL server here
// (compositor/transport/tcp).
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>

#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "compositor/transport/tcp/address.h"

namespace understudy::launcher {

struct ListenerPlan {
  compositor::TcpAddress address;
  std::filesystem::path secret_file;  ///< empty: clients have keys
  std::filesystem::path key_file;     ///< of this server; empty: clients have the secret
  std::filesystem::path clients;      ///< their public keys, with key_file
  std::filesystem::path nodes;        ///< the nodes' socket
  std::filesystem::path server;       ///< the GL server's; empty: none is offered
  std::filesystem::path folder;       ///< private; must exist
  bool plain = false;                 ///< clients of this machine may do without encryption
};

struct OpenListener {
  std::unique_ptr<ChildProcess> process;
  compositor::TcpAddress address;  ///< with the port that was taken, if any would do
};

/// Returns once it listens. Throws std::runtime_error when it does not; why, it has said itself.
OpenListener start_listener(const Installation& installation, const ListenerPlan& plan);

/// Adds the subcommand `listener`, which is not shown in the help.
void add_listener(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
