// SPDX-License-Identifier: Apache-2.0
// `understudy units`: the stream processing units that chains are made of, with their options.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "spu/registry/assemble.h"

namespace understudy::launcher {

std::string units_text(spu::UnitTable units);

void add_units(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
