// SPDX-License-Identifier: Apache-2.0
// Decides how many ranks a node group has, on which hosts, and what starts them there.
//
// Rank 0 shares a Unix socket and memory with the viewer, so one host must be the launcher's own; it is the
// first.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/hosts/hostfile.h"
#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

enum class Launch {
  this_machine,  ///< mpirun starts all ranks itself
  remote_shell,  ///< through a launch agent such as ssh, on the listed hosts
  slurm          ///< through Slurm, on the hosts of its allocation, or on the listed ones among them
};

struct Placement {
  Launch launch = Launch::this_machine;
  int ranks = 0;            ///< 0: no group was requested
  std::vector<Host> hosts;  ///< hosts of the hostfile, this machine first; empty without a hostfile
};

/// What was requested on the command line or by its environment variable.
struct PlacementWish {
  std::optional<int> ranks;        ///< -n
  std::filesystem::path hostfile;  ///< empty: none
};

/// Without -n, the number of ranks is that of the hostfile's slots; without a hostfile, the number of tasks of
/// a Slurm allocation to which this machine belongs, if there is more than one. Throws std::runtime_error with
/// one line if the hostfile is invalid, or this machine is not in it.
Placement placement_of(const PlacementWish& wish, const Environment& environment,
                       const std::function<bool(const std::string&)>& is_here = is_this_machine);

/// The same without the hosts in `gone`: at most as many ranks as slots, unless there were more before.
Placement without_hosts(const Placement& placement, const std::vector<std::string>& gone);

}  // namespace understudy::launcher
