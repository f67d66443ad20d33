// SPDX-License-Identifier: Apache-2.0
// How many ranks a node group has, on which hosts, and who starts them there.
//
// Rank 0 shares a Unix socket and memory with the viewer, so one host must be the launcher's own, and it comes
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
  remote_shell,  ///< through a launch agent such as ssh, on hosts that were listed
  slurm          ///< through Slurm, on the hosts of its allocation, or on those of them that were listed
};

struct Placement {
  Launch launch = Launch::this_machine;
  int ranks = 0;            ///< 0: no group is wanted
  std::vector<Host> hosts;  ///< of the hostfile, this machine first; empty without one
};

/// What was asked for, on the command line or by its variable.
struct PlacementWish {
  std::optional<int> ranks;        ///< -n
  std::filesystem::path hostfile;  ///< empty: none
};

/// Ranks that were not asked for are those of the hostfile's slots, and without a hostfile the tasks of a Slurm
/// allocation that this machine belongs to, if there is more than one. Throws std::runtime_error with one line
/// when the hostfile does not do, or this machine is not in it.
Placement placement_of(const PlacementWish& wish, const Environment& environment,
                       const std::function<bool(const std::string&)>& is_here = is_this_machine);

/// The same on the hosts that are left: no more ranks than slots, unless there were more before.
Placement without_hosts(const Placement& placement, const std::vector<std::string>& gone);

}  // namespace understudy::launcher
