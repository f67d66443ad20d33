// SPDX-License-Identifier: Apache-2.0
// Finds the hosts that answer: runs the node's program with --help on all of them at once, through the launch
// agent.
//
// Open MPI aborts a whole job if one host cannot be reached, possibly after minutes. A group is therefore
// started only on hosts that have just shown that they can run the program.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/hosts/hostfile.h"
#include "apps/understudy/processes/child_process.h"

namespace understudy::launcher {

constexpr std::chrono::seconds patience_with_host{10};

struct SilentHost {
  std::string name;
  std::string trouble;  ///< "does not answer (…)", "cannot run …"
};

class HostProbe {
 public:
  /// Starts one process of `agent` per host, in `environment`, with its output in files in `folder`. Throws
  /// std::system_error if the agent cannot be executed.
  HostProbe(const std::vector<Host>& hosts, const std::vector<std::string>& agent,
            const std::filesystem::path& node, const Environment& environment,
            const std::filesystem::path& folder);

  /// Returns whether all processes have ended or time is up. Call again when a child of this process has
  /// ended, or after a second.
  bool finished();

  /// Call once when finished: ends processes that still run, and returns the hosts that did not answer.
  std::vector<SilentHost> silent();

 private:
  struct Question {
    std::string host;
    std::filesystem::path words;
    ChildProcess process;
  };

  std::filesystem::path node_;
  std::vector<Question> questions_;
  std::chrono::steady_clock::time_point until_;
};

}  // namespace understudy::launcher
