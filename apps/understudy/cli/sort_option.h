// SPDX-License-Identifier: Apache-2.0
// `--sort` of `run`, `replay`, `render`, `study`, `view` and `serve`: whether nodes divide volumes or images.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

void add_sort_option(CLI::App& subcommand, std::string& sort);

}  // namespace understudy::launcher
