// `understudy run [options] -- viewer args…`: the viewer as a child process with a door open, nodes behind it
// when asked for, and the figures of the run at its end. The exit status is the viewer's own (128 + signal when
// killed).
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace understudy::launcher {

constexpr int usage_error = 2;
constexpr int cannot_start_viewer = 127;

/// The arguments of this program, and those of the viewer behind the first "--".
struct CommandLine {
  std::vector<char*> own;
  std::vector<std::string> viewer;
};

CommandLine split_at_double_dash(int argc, char** argv);

/// Adds the subcommand; when it is parsed, `chosen` runs it.
void add_run(CLI::App& app, const std::vector<std::string>& viewer, std::function<int()>& chosen);

}  // namespace understudy::launcher
