// SPDX-License-Identifier: Apache-2.0
// `understudy study --out DIR`: measures error against run time over a grid of settings and a set of scenes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_study(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
