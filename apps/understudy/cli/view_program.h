// SPDX-License-Identifier: Apache-2.0
// `understudy view` is a separate program, understudy-view: a window needs libraries that would delay the
// start of every other command.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace understudy::launcher {

constexpr const char* view_description = "shows a volume file in a browser or a window, without OpenGL";

/// Adds the subcommand, which accepts any arguments. When chosen, it replaces this process by understudy-view
/// with `arguments`; throws std::runtime_error if that program cannot be started.
void add_view_program(CLI::App& app, const std::vector<std::string>& arguments, std::function<int()>& chosen);

}  // namespace understudy::launcher
