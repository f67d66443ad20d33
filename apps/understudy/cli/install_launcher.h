// SPDX-License-Identifier: Apache-2.0
// `understudy install-launcher`: an entry of the desktop's menu that starts a viewer under Understudy.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace understudy::launcher {

/// Adds the subcommand, which takes the options of `run` behind "--"; when it is parsed, `chosen` runs it.
void add_install_launcher(CLI::App& app, const std::vector<std::string>& options, std::function<int()>& chosen);

}  // namespace understudy::launcher
