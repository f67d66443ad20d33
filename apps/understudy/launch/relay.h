// SPDX-License-Identifier: Apache-2.0
// Connections to nodes and GL servers on other machines: a process listens at a local Unix socket, which
// viewers use like that of local nodes or a local GL server, and relays messages over TCP
// (compositor/transport/tcp).
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "compositor/transport/tcp/handshake.h"

namespace understudy::launcher {

struct ConnectionPlan {
  std::string address;  ///< host:port
  std::filesystem::path secret_file;
  std::filesystem::path key_file;    ///< with server_key, instead of a secret
  std::filesystem::path server_key;  ///< the public key of the server
  compositor::ConnectionRequest connection_request;

  bool has_credentials() const { return !secret_file.empty() || !key_file.empty(); }
};

/// Returns the message for a connection to `address` without credentials.
std::string lack_of_credentials(const std::string& address);

/// Checks that both ends authenticate each other. Throws std::runtime_error with what is wrong and what to do.
void try_connection(const ConnectionPlan& plan);

/// Starts the relay; returns once it listens at `socket`. The relay writes the figures of each connection to
/// `folder` (connection_figures.h). Throws std::runtime_error.
std::unique_ptr<ChildProcess> start_relay(const Installation& installation, const ConnectionPlan& plan,
                                          const std::filesystem::path& socket,
                                          const std::filesystem::path& folder);

/// Runs `job` with a socket that leads to the nodes at `address`; their images are sent in the format `pixels`
/// (compositor::set_layout). Throws what the job throws, and std::runtime_error.
void with_connection(ConnectionPlan plan, const std::string& address, const std::string& pixels,
                     const std::function<void(const std::string& socket)>& job);

/// `--secret-file`, `--key`, `--server-key`, `--quality` and `--plain`, for commands with --connect.
void add_connection_options(CLI::App& subcommand, ConnectionPlan& plan);

/// Adds the subcommand `relay`, which is not shown in the help.
void add_relay(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
