// SPDX-License-Identifier: Apache-2.0
// Runs one rank of a node group: rank 0 receives the applications' requests and tells all ranks what to do;
// every rank keeps and draws its share; images are composited (exchange/) in the application's image buffer.
#pragma once

#include <chrono>
#include <string>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/settings.h"
#include "compositor/node/rebalancer.h"
#include "compositor/service/client_limits.h"
#include "compositor/service/limits.h"
#include "compositor/sort/sort.h"
#include "volume/file/readable_files.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::compositor {

struct NodeSettings {
  /// Applications that pause for longer in the middle of a message are dropped.
  std::chrono::milliseconds stall_patience = limits::stall_patience;
  ExchangeSettings exchange;
  /// Makes the renderer of a rank's bricks.
  volume::BrickRendererFactory make_renderer = volume::cpu_renderer;
  /// Whether ranks divide volumes or images.
  SortSettings sort;
  /// Which rank gets which bricks; for Sort::last.
  BalanceSettings balance;
  volume::ReadableFiles files;  ///< that applications may load
  ClientLimits limits = client_limits(1, {});
};

/// Collective over `communicator`: every rank of the group calls it with the same arguments. Returns true when
/// the launcher at `control_path` has closed its connection; false, on rank 0, if it could not be reached: that
/// has been logged, and the other ranks return as well.
///
/// If one rank cannot perform a request (memory, a senseless request), all ranks learn it before anything
/// depends on it, and the application gets a refusal. Any other failure, such as lack of memory in the middle
/// of an exchange, is thrown: the caller must then end the group with communicator.abandon(), or the other
/// ranks would wait for ever.
bool run_node(Communicator& communicator, const std::string& control_path, const NodeSettings& settings = {});

}  // namespace understudy::compositor
