// SPDX-License-Identifier: Apache-2.0
// `understudy completion SHELL` and `understudy manual`: generate shell completion and the manual page, which
// are installed with the program, from its options.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_completion(CLI::App& app, std::function<int()>& chosen);
void add_manual(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
