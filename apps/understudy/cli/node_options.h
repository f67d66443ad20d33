// SPDX-License-Identifier: Apache-2.0
// Options of commands that start nodes: `--exchange`, `--pixels`, `--gather` and `--overlap` (compositing),
// `--hostfile` (where ranks run), and `--server-opengl` and `--sandbox` (of GL servers).
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "apps/understudy/launch/node_choices.h"

namespace understudy::launcher {

/// Adds options of spu/options.h; their environment variables apply, too, as they do to viewers
/// that start nodes themselves.
void add_exchange_options(CLI::App& subcommand, NodeChoices& choices);

/// `--tiles`, for commands that start a GL server.
void add_tiles_option(CLI::App& subcommand, std::string& tiles);

/// `--server-opengl` of spu/options.h: what a GL server beside the nodes draws with.
void add_gl_server_option(CLI::App& subcommand, std::string& opengl);
void add_sandbox_option(CLI::App& subcommand, std::string& sandbox);

void add_hostfile_option(CLI::App& subcommand, std::filesystem::path& hostfile);

}  // namespace understudy::launcher
