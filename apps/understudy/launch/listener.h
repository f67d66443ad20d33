// SPDX-License-Identifier: Apache-2.0
// The listener of `understudy serve --listen`: a process that accepts clients of other machines if they
// authenticate, and starts a process for each, which relays its messages to the nodes or to the GL server here
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
  std::filesystem::path secret_file;  ///< empty: clients authenticate by keys
  std::filesystem::path key_file;     ///< key of this server; empty: clients authenticate by the secret
  std::filesystem::path clients;      ///< file of the clients' public keys, with key_file
  std::filesystem::path nodes;        ///< socket of the nodes
  std::filesystem::path server;       ///< socket of the GL server; empty: none is offered
  std::filesystem::path folder;       ///< private; must exist
  bool plain = false;                 ///< clients on this machine may connect without encryption
};

struct OpenListener {
  std::unique_ptr<ChildProcess> process;
  compositor::TcpAddress address;  ///< with the actual port, if any port was allowed
};

/// Returns once the listener listens. Throws std::runtime_error if it does not; the listener
/// itself prints the reason.
OpenListener start_listener(const Installation& installation, const ListenerPlan& plan);

/// Adds the subcommand `listener`, which is not shown in the help.
void add_listener(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
