// SPDX-License-Identifier: Apache-2.0
// Normals of a ray's samples over a field that rises evenly. Near the ends of the texture they are others than
// in its middle: a neighbour beyond the end has the value of the end, and half a texel from it linear filtering
// leaves nothing to rise.
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
  /// Between the normal and the direction to the eye, times the length that a guard leaves the normal; null:
  /// there is no normal.
  std::optional<double> cosine;
  double share = 0;  ///< of the ray's opacity; all add up to 1
};

/// A field whose texels rise by `gradient` per unit of texture space, as central differences see it.
struct EvenRise {
  volume::Vec3 gradient{};
  std::array<int, 3> texels{};  ///< of the field's texture
  volume::Vec3 reach{};         ///< to both sides of a sample, in texture space
};

/// The field's gradient at `place`, as central differences see it.
volume::Vec3 seen_gradient(const EvenRise& field, const volume::Vec3& place);

/// `opacities` are those of the samples, from the eye on.
std::vector<NormalShare> ray_normals(const WayThroughBox& way, const volume::RaySteps& steps,
                                     std::span<const double> opacities, const LightSpace& space,
                                     const EvenRise& field, const volume::NormalGuard& guard = {});

/// What `light`, which has a response, makes of a colour where the gradient is at this cosine to the eye;
/// clamped, if it clamps.
Tint lit_tint(const volume::Light& light, const std::optional<double>& cosine, const Tint& base);
/// On average over a ray.
Tint lit_tint(const volume::Light& light, const std::vector<NormalShare>& normals, const Tint& base);

}  // namespace understudy::spu
