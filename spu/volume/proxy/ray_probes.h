// SPDX-License-Identifier: Apache-2.0
// Rays through the application's box, probed over constant fields.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

/// A ray at normalised device coordinates (x, y).
struct Ray {
  double x = 0;
  double y = 0;
  double length = 0;  ///< in steps
};

/// Returns the ray in view whose length comes closest to `wanted` steps, searched from the middle of the box
/// outwards.
Ray ray_of_length(const RaysThroughBox& rays, const volume::RaySteps& steps, double wanted);

/// Likewise in each of 16 directions from the middle of the box; lengths differ from `wanted` where none comes
/// close.
std::vector<Ray> rays_of_length(const RaysThroughBox& rays, const volume::RaySteps& steps, double wanted);

/// Whether the colour of a ray changes when the field of `value` gets the slightest slope, as it would under
/// lighting.
bool depends_on_gradient(const MarchContext& measured, FieldProbe& probe, const Ray& ray, float value);

/// Whether all fragments of a ray, over constant fields of `values`, add up to the `nearest` ones. If faces are
/// not culled, the front and the back fragment are blended. Fragments that replace what is there leave the
/// nearest one (RayCasterStage).
bool only_nearest_shows(const MarchContext& measured, FieldProbe& probe, const Ray& ray,
                        const std::vector<float>& values, const std::vector<volume::Rgba>& nearest);

/// A value whose constant field lets about half of the light through a ray.
struct TranslucentRay {
  Ray ray;
  float value = 0;
};

/// Returns the longest ray on which one of `values` is translucent: where samples are nearly opaque, only short
/// rays let light through. `texels`: steps of one texel.
std::optional<TranslucentRay> translucent_ray(const MarchContext& measured, FieldProbe& probe,
                                              const RaysThroughBox& rays, const volume::RaySteps& texels,
                                              const March& march, const std::vector<float>& values);

/// Returns counts of samples on rays all over the box, or why they cannot be counted.
std::variant<std::vector<CountedRay>, std::string> counted_rays(const MarchContext& measured, FieldProbe& probe,
                                                                const RaysThroughBox& rays, const March& march);

/// Returns the length, in steps of `texels`, from which on a ray has a sample: at the box's silhouette rays are
/// as short as can be, and those that are too short show nothing. `shown` is what the field of `value` looks
/// like.
double shortest_seen(FieldProbe& probe, const RaysThroughBox& rays, const volume::RaySteps& texels, float value,
                     const volume::Rgba& shown);

/// Removes the noise at the rays' beginnings, if there is any; false if that fails.
bool held_still(const MarchContext& measured, FieldProbe& probe, const March& march);

}  // namespace understudy::spu
