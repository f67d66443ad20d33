// `--exchange` and `--pixels` of commands that start nodes: how partial pictures become one.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

/// As spu/options.h has them; their variables count too, for viewers that start nodes of their own.
void add_exchange_options(CLI::App& subcommand, std::string& exchange, std::string& pixels);

}  // namespace understudy::launcher
