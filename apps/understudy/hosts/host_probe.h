// SPDX-License-Identifier: Apache-2.0
// Which hosts answer: the node's program is asked for its help on all of them at once, through the launch
// agent.
//
// Open MPI gives a whole job up when one host cannot be reached, and may wait for minutes before. A group is
// therefore started only on hosts that have just shown that they can run the program.
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
  /// Starts one process of `agent` a host, in `environment`. What they say goes to files in `folder`. Throws
  /// std::system_error when the agent cannot be executed.
  HostProbe(const std::vector<Host>& hosts, const std::vector<std::string>& agent,
            const std::filesystem::path& node, const Environment& environment,
            const std::filesystem::path& folder);

  /// All have ended, or patience has. Look again when a child of this process has ended, or a second later.
  bool finished();

  /// Call once when finished: ends those that still run, and tells which hosts did not answer.
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
