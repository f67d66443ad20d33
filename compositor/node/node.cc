// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/node.h"

#include "compositor/node/rank_loop.h"

namespace understudy::compositor {

bool run_node(Communicator& communicator, const std::string& control_path,
              std::chrono::milliseconds stall_patience, const ExchangeSettings& exchange,
              const volume::BrickRendererFactory& make_renderer, const BalanceSettings& balance,
              const volume::ReadableFiles& files, const ClientLimits& limits) {
  RankLoop node(communicator, exchange, make_renderer, balance, files, limits);
  if (communicator.rank() == 0) return node.lead(control_path, stall_patience);
  node.follow();
  return true;
}

}  // namespace understudy::compositor
