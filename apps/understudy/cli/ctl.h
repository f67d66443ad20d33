// SPDX-License-Identifier: Apache-2.0
// `understudy ctl`: lists the viewers that run under Understudy, and changes what Understudy does in them.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_ctl(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
