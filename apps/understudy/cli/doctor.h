// SPDX-License-Identifier: Apache-2.0
// `understudy doctor`: prints what works on this machine, one line each, with a fix for what does not.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace understudy::launcher {

void add_doctor(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
