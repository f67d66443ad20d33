// `--backend` of `run`, `replay` and `serve`: who casts the nodes' rays.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

void add_backend_option(CLI::App& subcommand, std::string& backend);

}  // namespace understudy::launcher
