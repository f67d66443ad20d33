// SPDX-License-Identifier: Apache-2.0
// Spaces in which ray casters take steps of one length.
#pragma once

#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "volume/texture_space.h"

namespace understudy::spu {

/// Returns how long the axes of texture space are in each of them: in texels of a texture of `size`, in the
/// world that the camera shows (if it shows it), and in texture space itself. Rays of nearly one direction do
/// not distinguish them.
std::vector<volume::Vec3> step_spaces(const std::array<int, 3>& size, const volume::Matrix4& texture_to_clip,
                                      const FieldProbe& probe);

}  // namespace understudy::spu
