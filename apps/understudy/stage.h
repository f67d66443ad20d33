// The stage: makes the OpenGL calls of applications that have none (`understudy run --remote`), on contexts
// without a window system, through the chain that a viewer here would have, and sends their pictures home.
//
// One process listens; every application gets a process of its own, so that neither a driver's faults nor a
// closed connection concern another one.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>

#include "apps/understudy/child_process.h"
#include "apps/understudy/environment.h"
#include "apps/understudy/installation.h"

namespace understudy::launcher {

/// Starts a stage that listens at `socket`, with the options in `environment` and no door. Returns once it
/// does. Throws std::runtime_error when it does not.
std::unique_ptr<ChildProcess> start_stage(const Installation& installation, const std::filesystem::path& socket,
                                          Environment environment);

/// Adds the subcommand `stage`, which is not shown in the help.
void add_stage(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
