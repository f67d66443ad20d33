// SPDX-License-Identifier: Apache-2.0
// A level of detail as a volume of its own: the positions of its samples in the volume's space.
#pragma once

#include <array>

#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// The volume's box in the texture space of one of its levels: sample i of the level is sample i 2^level of the
/// volume. It may extend beyond [0,1], by less than a sample.
Box volume_in_level(const std::array<int, 3>& volume_size, int level);

/// Converts a request on steps for a volume into the equivalent request for one of its levels.
void show_level(RenderRequest& request, const std::array<int, 3>& volume_size, int level);

}  // namespace understudy::volume
