// SPDX-License-Identifier: Apache-2.0
// `--backend` of `run`, `replay`, `serve` and `render`: what casts the nodes' rays; and `--gpu-memory`: its
// limit of graphics memory.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

void add_backend_option(CLI::App& subcommand, std::string& backend);

/// Call it after add_backend_option(). `gpu_memory` becomes "auto" or a number of bytes.
void add_gpu_memory_option(CLI::App& subcommand, std::string& gpu_memory);

}  // namespace understudy::launcher
