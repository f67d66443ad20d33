// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/node.h"

#include "compositor/node/rank_loop.h"

namespace understudy::compositor {

bool run_node(Communicator& communicator, const std::string& control_path, const NodeSettings& settings) {
  RankLoop node(communicator, settings);
  if (communicator.rank() == 0) return node.lead(control_path, settings.stall_patience);
  node.follow();
  return true;
}

}  // namespace understudy::compositor
