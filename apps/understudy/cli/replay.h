// SPDX-License-Identifier: Apache-2.0
// `understudy replay TRACE`: plays what `understudy run --trace` has recorded, without a
// viewer and without a display.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_replay(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
