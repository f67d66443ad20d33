// SPDX-License-Identifier: Apache-2.0
// The GL server: executes the OpenGL calls of applications without OpenGL (`understudy run --remote`), on
// contexts without a window system, through the chain that a local viewer would have, and returns their
// images.
//
// One process listens. Every application gets its own process (client_process.h), so that neither a crashing
// driver nor a closed connection affects the others. This process first opens what it draws with, then closes
// a sandbox (apps/understudy/sandbox), and only then reads calls.
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
/// Returns once it listens. Throws std::runtime_error if it does not.
std::unique_ptr<ChildProcess> start_gl_server(const Installation& installation,
                                              const std::filesystem::path& socket, Environment environment);

/// Adds the subcommand `gl-server`, which is not shown in the help.
void add_gl_server_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
