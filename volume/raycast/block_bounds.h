// What a block can add to a maximum: rays pass by blocks that show nothing larger than what they have seen.
#pragma once

#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/raycast/transfer_table.h"

namespace understudy::volume {

/// Per block the largest first component that a sample of it can have. Empty when `table` does not rise with
/// the value, strictly in its first component: only then does the first component alone decide a maximum.
std::vector<float> block_bounds(const BrickStore& store, const TransferTable& table);

/// The same for one block, under a table that rises.
float block_bound(const BrickStore& store, const TransferTable& table, std::size_t block);

}  // namespace understudy::volume
