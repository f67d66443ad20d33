// SPDX-License-Identifier: Apache-2.0
// The life of a render node: rank 0 listens to the applications and tells all ranks what to do; every rank
// keeps and draws its share; the images are composited (exchange/) and rank 0 leaves the image in the
// application's memory.
#pragma once

#include <chrono>
#include <string>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/settings.h"
#include "compositor/node/rebalancer.h"
#include "compositor/service/client_limits.h"
#include "compositor/service/limits.h"
#include "volume/file/readable_files.h"
#include "volume/raycast/brick_renderer.h"

namespace understudy::compositor {

/// Collective over `communicator`: every rank of the group calls it with the same arguments. Returns true when
/// the launcher behind `control_path` has closed its connection; false, on rank 0, when it could not be
/// reached: that has been said on stderr, and the other ranks return as well.
///
/// Each rank draws its bricks with what `make_renderer` makes; who gets which bricks is balanced as `balance`
/// says. Applications may load `files`, and ask for what is within `limits`.
///
/// What one rank cannot do (memory, a senseless request) all ranks learn before anything depends on it, and the
/// application gets a refusal. Applications that pause for longer than
/// `stall_patience` in the middle of a message are dropped. Anything else that fails, such as memory in the
/// middle of an exchange, is thrown: the caller then must end the group with communicator.abandon(), or the
/// other ranks would wait for ever.
bool run_node(Communicator& communicator, const std::string& control_path,
              std::chrono::milliseconds stall_patience = limits::stall_patience,
              const ExchangeSettings& exchange = {},
              const volume::BrickRendererFactory& make_renderer = volume::cpu_renderer,
              const BalanceSettings& balance = {}, const volume::ReadableFiles& files = {},
              const ClientLimits& limits = client_limits(1, {}));

}  // namespace understudy::compositor
