// SPDX-License-Identifier: Apache-2.0
// Options of commands that start nodes: `--exchange`, `--pixels`, `--gather` and `--overlap`, how partial
// images become one, `--hostfile`, where the ranks are, and `--server-opengl` and `--sandbox`, of GL servers.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "apps/understudy/launch/node_choices.h"

namespace understudy::launcher {

/// As spu/options.h has them; their variables count too, for viewers that start nodes of their own.
void add_exchange_options(CLI::App& subcommand, NodeChoices& choices);

/// `--tiles`, of those who start a GL server.
void add_tiles_option(CLI::App& subcommand, std::string& tiles);

/// What a GL server beside the nodes draws with, as spu/options.h has it.
void add_gl_server_option(CLI::App& subcommand, std::string& opengl);
void add_sandbox_option(CLI::App& subcommand, std::string& sandbox);

void add_hostfile_option(CLI::App& subcommand, std::filesystem::path& hostfile);

}  // namespace understudy::launcher
