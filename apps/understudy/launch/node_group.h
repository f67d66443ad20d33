// SPDX-License-Identifier: Apache-2.0
// The render nodes behind one socket of this machine: a broker that owns the socket, and mpirun with N ranks
// behind it, here or on several hosts.
//
// OpenMPI ends a whole job when one rank dies. The socket is therefore the broker's, not the nodes': a lost
// group is replaced by a new one (a bounded number of times, with growing pauses), and viewers find it at the
// same address. Groups on other hosts are started on those that have just answered. A group that hangs is
// noticed by the broker, and ended from here.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/hosts/host_probe.h"
#include "apps/understudy/hosts/mpi_launcher.h"
#include "apps/understudy/hosts/placement.h"
#include "apps/understudy/launch/node_choices.h"
#include "apps/understudy/launch/restarts.h"
#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "compositor/service/broker.h"

namespace understudy::launcher {

/// From mpirun's start to rank 0's hello.
constexpr std::chrono::seconds patience_with_start{60};

struct NodeGroupPlan {
  Placement placement{Launch::this_machine, 1, {}};
  std::filesystem::path socket;
  std::filesystem::path folder;  ///< private, for the nodes' socket and log, and mpirun's own files; must exist
  NodeChoices choices;
};

/// Why no nodes can be started here, with the fix, in one line; empty when they can.
std::string obstacle_to_nodes(const Installation& installation);

/// What the nodes in `folder` have said about who casts their rays, and why: a line for each choice.
std::vector<std::string> backend_choices(const std::filesystem::path& folder);

class NodeGroup {
 public:
  /// Takes the sockets and starts mpirun, or first asks the other hosts whether they answer; returns without
  /// waiting for either. Throws std::runtime_error (socket taken, mpirun or the launch agent cannot be
  /// executed).
  NodeGroup(const Installation& installation, const NodeGroupPlan& plan);
  NodeGroup(const NodeGroup&) = delete;
  NodeGroup& operator=(const NodeGroup&) = delete;
  ~NodeGroup();

  bool ready() const { return broker_.node_group_ready(); }
  /// Of the group that is there; 0 without one.
  int ranks() const { return broker_.ranks(); }

  /// Waits until something happens on the broker's sockets or on `other`, or a restart is due, and serves it.
  void wait_and_serve(int other);

  /// Call when a child of this process may have ended: a lost group is said in one line and planned anew.
  void look_after_children();

 private:
  using Clock = std::chrono::steady_clock;

  void start();
  void start_on(const Placement& placement);
  void start_when_due();
  void start_on_hosts_that_answer();
  void try_to(const std::function<void()>& start);
  void end_what_hangs();

  Installation installation_;
  NodeGroupPlan plan_;
  compositor::Broker broker_;
  std::optional<HostProbe> probe_;       ///< before a start
  std::optional<MpiLauncher> launcher_;  ///< asked for its version once: the broker waits meanwhile
  std::optional<ChildProcess> mpirun_;
  std::filesystem::path group_folder_;  ///< in the plan's folder: what mpirun_ keeps there
  int groups_ = 0;                      ///< started so far
  Clock::time_point started_at_;
  std::string why_lost_;          ///< the broker's words
  std::string why_ended_;         ///< if the group had to be ended from here
  std::uintmax_t log_start_ = 0;  ///< where the present group's lines begin
  Clock::time_point lost_at_;
  Restarts restarts_;
  std::optional<Clock::time_point> next_start_;
};

}  // namespace understudy::launcher
