// SPDX-License-Identifier: Apache-2.0
// Lighting of a point of the field, in double precision: a literal implementation of volume/light.h.
#pragma once

#include "volume/description.h"
#include "volume/light.h"
#include "volume/reference/slice_sum.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// The field's gradient at t per texel of `volume`, by central differences over `reach` texels. On a repeating
/// axis, sampled positions stay within half a texel of the texture.
Vec3 texel_gradient(const Field& field, const VolumeDescription& volume, const Vec3& t,
                    const Vec3& reach = {1, 1, 1});

/// Lights the premultiplied `colour` of the point t, on a ray with direction `way` in texture space.
std::array<double, 4> illuminated(const Field& field, const VolumeDescription& volume, const Light& light,
                                  const Vec3& t, const Vec3& way, const std::array<double, 4>& colour);

}  // namespace understudy::volume
