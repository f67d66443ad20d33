// SPDX-License-Identifier: Apache-2.0
// What a block can add to a maximum: rays pass by blocks that show nothing larger than what they have seen.
#pragma once

#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/raycast/transfer_table.h"

namespace understudy::volume {

/// Per block the largest sum of components that a sample of it can have. Empty when a component of `table`
/// falls anywhere, or is negative: only of colours that rise together is the maximum one of them, and the one
/// whose components have the largest sum.
std::vector<float> block_bounds(const BrickStore& store, const TransferTable& table);

/// The same for one block, under a table that rises.
float block_bound(const BrickStore& store, const TransferTable& table, std::size_t block);

}  // namespace understudy::volume
