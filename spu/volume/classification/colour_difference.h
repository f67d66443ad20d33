// SPDX-License-Identifier: Apache-2.0
// Comparison of colours that were drawn.
#pragma once

#include <vector>

#include "volume/rgba.h"

namespace understudy::spu {

/// Returns the largest difference over the four channels.
float largest_difference(const volume::Rgba& a, const volume::Rgba& b);

/// Returns whether all channels are finite.
bool finite(const std::vector<volume::Rgba>& colours);

}  // namespace understudy::spu
