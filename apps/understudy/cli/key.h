// SPDX-License-Identifier: Apache-2.0
// `understudy key FILE`: makes a key pair, with which a user or a server authenticates.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_key(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
