// SPDX-License-Identifier: Apache-2.0
// `understudy units`: lists the stream processing units that chains can use, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_units(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
