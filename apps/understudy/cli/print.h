// SPDX-License-Identifier: Apache-2.0
// `understudy print TRACE`: prints the records of a trace, one line each.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_print(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
