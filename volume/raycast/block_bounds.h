// SPDX-License-Identifier: Apache-2.0
// Upper bounds of blocks under a maximum: rays skip blocks that show nothing larger than their maximum so far.
#pragma once

#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/raycast/transfer_table.h"

namespace understudy::volume {

/// Per block the largest sum of components that a sample in it can have. Empty when a component of `table` is
/// negative or decreases anywhere: only among colours whose components increase together is the componentwise
/// maximum one of them, and the one with the largest sum.
std::vector<float> block_bounds(const BrickStore& store, const TransferTable& table);

/// The same for one block, for a `table` without negative or decreasing components.
float block_bound(const BrickStore& store, const TransferTable& table, std::size_t block);

}  // namespace understudy::volume
