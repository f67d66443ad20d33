// SPDX-License-Identifier: Apache-2.0
// `--partition` of `run`, `replay`, `render`, `study`, `view` and `serve`: how the volume is partitioned
// among nodes that divide it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

void add_partition_option(CLI::App& subcommand, std::string& partition);

}  // namespace understudy::launcher
