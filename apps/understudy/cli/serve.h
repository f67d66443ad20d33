// SPDX-License-Identifier: Apache-2.0
// `understudy serve -n N [--socket PATH]`: keeps a node group running, which viewers connect to.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_serve(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
