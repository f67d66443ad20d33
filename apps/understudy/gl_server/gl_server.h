// SPDX-License-Identifier: Apache-2.0
// The GL server: makes the OpenGL calls of applications that have none (`understudy run --remote`), on contexts
// without a window system, through the chain that a viewer here would have, and sends their images back.
//
// One process listens; every application gets a process of its own (client_process.h), so that neither a
// driver's faults nor a closed connection concern another one. What it draws with is opened first; then a
// sandbox closes (apps/understudy/sandbox), and only then calls are read.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>

#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {

/// Starts a GL server that listens at `socket`, with the options in `environment` and no injection method.
/// Returns once it does. Throws std::runtime_error when it does not.
std::unique_ptr<ChildProcess> start_gl_server(const Installation& installation,
                                              const std::filesystem::path& socket, Environment environment);

/// Adds the subcommand `gl-server`, which is not shown in the help.
void add_gl_server_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
