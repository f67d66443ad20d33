// SPDX-License-Identifier: Apache-2.0
// A level of detail as a volume of its own: where its samples lie in the volume's space.
#pragma once

#include <array>

#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// The volume in the texture space of one of its levels: sample i of the level is sample i 2^level of the
/// volume. It may reach beyond [0,1], by less than a sample.
Box volume_in_level(const std::array<int, 3>& volume_size, int level);

/// Turns a request on steps for a volume into the same one for a level of it.
void show_level(RenderRequest& request, const std::array<int, 3>& volume_size, int level);

}  // namespace understudy::volume
