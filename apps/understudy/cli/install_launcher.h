// SPDX-License-Identifier: Apache-2.0
// `understudy install-launcher`: adds an entry to the desktop menu that starts a viewer under Understudy.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace understudy::launcher {

/// Adds the subcommand, which takes the options of `run` behind "--"; when it is
/// parsed, sets `chosen` to run it.
void add_install_launcher(CLI::App& app, const std::vector<std::string>& options, std::function<int()>& chosen);

}  // namespace understudy::launcher
