// SPDX-License-Identifier: Apache-2.0
// `understudy units`: the stream processing units that chains are made of, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_units(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
