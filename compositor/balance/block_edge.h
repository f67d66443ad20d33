// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "volume/brick/brick_store.h"

namespace understudy::compositor {

/// Bricks are cut at the faces of blocks with this many cells along each edge.
inline constexpr int block_edge = volume::BrickStore::block_cells;

}  // namespace understudy::compositor
