// SPDX-License-Identifier: Apache-2.0
// `understudy view` is a program of its own, understudy-view: a window needs libraries that every other command
// would have to wait for when it starts.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace understudy::launcher {

constexpr const char* view_description = "shows a volume file in a browser or a window, without OpenGL";

/// The subcommand, which takes whatever follows. Chosen, it gives this process to understudy-view with these
/// `arguments`, and throws std::runtime_error where that is not to be had.
void add_view_program(CLI::App& app, const std::vector<std::string>& arguments, std::function<int()>& chosen);

}  // namespace understudy::launcher
