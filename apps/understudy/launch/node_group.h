// SPDX-License-Identifier: Apache-2.0
// The render nodes behind one socket of this machine: a broker that owns the socket, and mpirun with N ranks,
// on this machine or on several hosts.
//
// Open MPI ends a whole job when one rank dies. The socket therefore belongs to the broker, not to the nodes: a
// lost group is replaced by a new one (a bounded number of times, with growing pauses), and viewers find it at
// the same address. Groups on other hosts are started only on hosts that have just answered. The broker detects
// a group that hangs; this class ends it.
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

/// Time from the start of mpirun to rank 0's hello.
constexpr std::chrono::seconds patience_with_start{60};

struct NodeGroupPlan {
  Placement placement{Launch::this_machine, 1, {}};
  std::filesystem::path socket;
  std::filesystem::path folder;  ///< private, for the nodes' socket and log, and for mpirun's files; must exist
  NodeChoices choices;
};

/// Returns why no nodes can be started here, with the fix, in one line; empty if they can.
std::string obstacle_to_nodes(const Installation& installation);

/// Returns the backends that the nodes in `folder` have reported, and why: a line for each choice.
std::vector<std::string> backend_choices(const std::filesystem::path& folder);

class NodeGroup {
 public:
  /// Opens the sockets and starts mpirun, or first probes whether the other hosts answer; returns
  /// without waiting for either. Throws std::runtime_error (socket in use, mpirun or the launch
  /// agent cannot be executed).
  NodeGroup(const Installation& installation, const NodeGroupPlan& plan);
  NodeGroup(const NodeGroup&) = delete;
  NodeGroup& operator=(const NodeGroup&) = delete;
  ~NodeGroup();

  bool ready() const { return broker_.node_group_ready(); }
  /// Number of ranks of the present group; 0 without one.
  int ranks() const { return broker_.ranks(); }

  /// Waits for an event on the broker's sockets or on `other`, or for a restart to be due, and handles it.
  void wait_and_serve(int other);

  /// Call when a child of this process may have ended: reports a lost group in one
  /// line and schedules a restart.
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
  std::optional<HostProbe> probe_;       ///< exists before a start on other hosts
  std::optional<MpiLauncher> launcher_;  ///< its version is queried once, because the broker waits meanwhile
  std::optional<ChildProcess> mpirun_;
  std::filesystem::path group_folder_;  ///< folder inside the plan's folder, for the files of mpirun_
  int groups_ = 0;                      ///< started so far
  Clock::time_point started_at_;
  std::string why_lost_;          ///< the broker's message
  std::string why_ended_;         ///< reason, if the group had to be ended from here
  std::uintmax_t log_start_ = 0;  ///< position in the log where the present group's lines begin
  Clock::time_point lost_at_;
  Restarts restarts_;
  std::optional<Clock::time_point> next_start_;
};

}  // namespace understudy::launcher
