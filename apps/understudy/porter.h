// Links to nodes and stages on other machines: a process that listens at a Unix socket here, so that viewers
// meet nodes or a stage as they do on one machine, and carries what they say over TCP (compositor/tcp).
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "apps/understudy/child_process.h"
#include "apps/understudy/installation.h"
#include "compositor/tcp/handshake.h"

namespace understudy::launcher {

struct LinkPlan {
  std::string address;  ///< host:port
  std::filesystem::path secret_file;
  compositor::LinkWishes wishes;
};

/// Whether both sides prove themselves, now. Throws std::runtime_error: what is wrong, and what to do.
void try_link(const LinkPlan& plan);

/// Returns once it listens at `socket`. What each of its links has done, it leaves in `folder`
/// (link_figures.h). Throws std::runtime_error.
std::unique_ptr<ChildProcess> start_porter(const Installation& installation, const LinkPlan& plan,
                                           const std::filesystem::path& socket,
                                           const std::filesystem::path& folder);

/// Does `job` with a socket behind which are the nodes at `address`; their pictures come home in `pixels`
/// (compositor::set_layout). Throws what the job throws, and std::runtime_error.
void with_link(LinkPlan plan, const std::string& address, const std::string& pixels,
               const std::function<void(const std::string& socket)>& job);

/// `--secret-file` and `--quality`, for commands with --connect.
void add_link_options(CLI::App& subcommand, LinkPlan& plan);

/// Adds the subcommand `porter`, which is not shown in the help.
void add_porter(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
