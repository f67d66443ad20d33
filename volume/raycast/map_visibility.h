// SPDX-License-Identifier: Apache-2.0
// Whether a block of colours can show anything under a linear map of colours.
#pragma once

#include <span>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"

namespace understudy::volume {

/// Bounds the mapped components over the ranges of a block's RGBA: never false where a sample shows.
bool shows(const LinearMap& map, std::span<const BrickStore::Range> texels);

}  // namespace understudy::volume
