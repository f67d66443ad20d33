// `understudy run [options] -- viewer args…`: the viewer as a child process with the entry library under it,
// nodes behind it when asked for, and the figures of the run at its end. The exit status is the viewer's own
// (128 + signal when killed), and with --require one that tells what was missing.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/understudy/environment.h"
#include "apps/understudy/relay.h"

namespace understudy::launcher {

constexpr int usage_error = 2;
constexpr int cannot_start_viewer = 127;

/// The arguments of this program, and those of the viewer behind the first "--".
struct CommandLine {
  std::vector<std::string> own;  ///< former options in today's words
  std::vector<std::string> viewer;
};

CommandLine split_at_double_dash(int argc, char** argv);

struct RunArguments {
  std::map<std::string, std::string> settings;  ///< environment variable → value, as given on the command line
  std::optional<InjectionMethod> injection =
      InjectionMethod::audit;       ///< none: the program makes its own chains
  std::filesystem::path trace;      ///< empty: nothing is recorded
  std::string backend = "cpu";      ///< who casts the nodes' rays
  std::string gpu_memory = "auto";  ///< what that may take of a graphics card, in bytes
  std::string balance = "off";      ///< who of the nodes gets how much of a volume
  std::filesystem::path hostfile;   ///< where the nodes are; empty: on this machine
  ConnectionPlan connection;        ///< how to get at --connect HOST:PORT
  bool remote = false;              ///< the viewer's calls are made by a GL server, not in its process
  bool required = false;            ///< a run without substituted frames is a failure
};

/// Runs the program with nodes behind it when they are asked for, and tells what happened. Returns its exit
/// status.
int run(const RunArguments& arguments, const std::vector<std::string>& command);

/// One command-line option for every row of the option table that has a flag, but for the flags in `without`.
void add_options_of_the_table(CLI::App& subcommand, const std::shared_ptr<RunArguments>& arguments,
                              std::span<const std::string_view> without = {});

/// Adds the subcommand; when it is parsed, `chosen` runs it.
void add_run(CLI::App& app, const std::vector<std::string>& viewer, std::function<int()>& chosen);

}  // namespace understudy::launcher
