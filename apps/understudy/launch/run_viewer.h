// SPDX-License-Identifier: Apache-2.0
// A run: the viewer as a child process with the entry library, nodes if requested, and the figures of the run
// at its end. The exit status is the viewer's own (128 + signal if it was killed); with `required`, one that
// reports what was missing.
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
      InjectionMethod::audit;       ///< none: the program makes its own chains, without injection
  std::filesystem::path trace;      ///< empty: nothing is recorded
  std::string backend = "cpu";      ///< what casts the nodes' rays
  std::string gpu_memory = "auto";  ///< limit of its graphics memory, in bytes
  std::string sort = "auto";        ///< whether nodes divide volumes or images
  std::string partition = "auto";   ///< how a volume is partitioned among nodes that divide it
  std::string balance = "off";      ///< load balancing between nodes
  std::filesystem::path hostfile;   ///< hosts of the nodes; empty: this machine
  ConnectionPlan connection;        ///< credentials and options for --connect HOST:PORT
  bool remote = false;              ///< the viewer's calls are executed by a GL server, not in its process
  bool required = false;            ///< a run without substituted frames is a failure
  bool quiet = false;               ///< print only warnings and errors
};

/// Runs the program, with nodes if requested, and reports what happened. Returns its exit status.
int run(const RunArguments& arguments, const std::vector<std::string>& command);

}  // namespace understudy::launcher
