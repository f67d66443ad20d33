// SPDX-License-Identifier: Apache-2.0
// Colours that were drawn, compared.
#pragma once

#include <vector>

#include "volume/rgba.h"

namespace understudy::spu {

/// Over the four channels.
float largest_difference(const volume::Rgba& a, const volume::Rgba& b);

/// Whether all channels are numbers.
bool finite(const std::vector<volume::Rgba>& colours);

}  // namespace understudy::spu
