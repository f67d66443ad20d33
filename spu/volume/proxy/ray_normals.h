// SPDX-License-Identifier: Apache-2.0
// Normals of a ray's samples over a linear field. Near the ends of the texture they differ from those in its
// middle: a neighbour beyond the end has the value of the end, and within half a texel of it linear filtering
// leaves no slope.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/light_space.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Colour over opacity, by channel.
using Tint = std::array<double, 3>;

/// Samples of a ray that have the same normal.
struct NormalShare {
  /// Cosine between the normal and the direction to the eye, times the length that a guard leaves the normal;
  /// null: there is no normal.
  std::optional<double> cosine;
  double share = 0;  ///< of the ray's opacity; all shares add up to 1
};

/// A field whose texels rise by `gradient` per unit of texture space, as seen by central differences.
struct EvenRise {
  volume::Vec3 gradient{};
  std::array<int, 3> texels{};  ///< of the field's texture
  volume::Vec3 reach{};         ///< of the differences, to both sides of a sample, in texture space
};

/// Returns the field's gradient at `place`, as seen by central differences.
volume::Vec3 seen_gradient(const EvenRise& field, const volume::Vec3& place);

/// Returns the normals of a ray's samples, from the eye on. `opacities` are those of the samples.
std::vector<NormalShare> ray_normals(const WayThroughBox& way, const volume::RaySteps& steps,
                                     std::span<const double> opacities, const LightSpace& space,
                                     const EvenRise& field, const volume::NormalGuard& guard = {});

/// Returns what `light`, which has a response, makes of a colour if the gradient is at this cosine to the eye;
/// clamped, if the light clamps.
Tint lit_tint(const volume::Light& light, const std::optional<double>& cosine, const Tint& base);
/// Likewise, averaged over a ray.
Tint lit_tint(const volume::Light& light, const std::vector<NormalShare>& normals, const Tint& base);

}  // namespace understudy::spu
