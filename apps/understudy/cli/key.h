// SPDX-License-Identifier: Apache-2.0
// `understudy key FILE`: makes the key by which a user or a server proves who it is.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_key(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
