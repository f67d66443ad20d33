// SPDX-License-Identifier: Apache-2.0
// A run: the viewer as a child process with the entry library under it, nodes behind it when asked for, and the
// figures of the run at its end. The exit status is the viewer's own (128 + signal when killed), and with
// `required` one that tells what was missing.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/launch/relay.h"
#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

constexpr int usage_error = 2;

struct RunArguments {
  std::map<std::string, std::string> settings;  ///< environment variable → value, as given on the command line
  std::optional<InjectionMethod> injection =
      InjectionMethod::audit;       ///< none: the program makes its own chains
  std::filesystem::path trace;      ///< empty: nothing is recorded
  std::string backend = "cpu";      ///< who casts the nodes' rays
  std::string gpu_memory = "auto";  ///< what that may take of a graphics card, in bytes
  std::string sort = "auto";        ///< what nodes divide
  std::string partition = "auto";   ///< where nodes that divide a volume cut it
  std::string balance = "off";      ///< who of the nodes gets how much of a volume
  std::filesystem::path hostfile;   ///< where the nodes are; empty: on this machine
  ConnectionPlan connection;        ///< how to get at --connect HOST:PORT
  bool remote = false;              ///< the viewer's calls are made by a GL server, not in its process
  bool required = false;            ///< a run without substituted frames is a failure
  bool quiet = false;               ///< nothing but warnings and errors is said
};

/// Runs the program with nodes behind it when they are asked for, and tells what happened. Returns its exit
/// status.
int run(const RunArguments& arguments, const std::vector<std::string>& command);

}  // namespace understudy::launcher
