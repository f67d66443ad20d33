// SPDX-License-Identifier: Apache-2.0
// Rays over fields with a slope, and the values on them that tell what light does.
#pragma once

#include <array>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "volume/light.h"

namespace understudy::spu {

/// Texels along each axis of a field with a slope: at both ends half a texel is even.
constexpr int slope_texels = 32;

/// Colour over opacity, by channel.
using Tint = std::array<double, 3>;

Tint tint_of(const volume::Rgba& premultiplied);
std::vector<Tint> tints_of(const std::vector<volume::Rgba>& colours);
/// In the channel in which they differ most.
double difference(const Tint& a, const Tint& b);
/// The largest channel of all.
double brightest(const std::vector<Tint>& tints);

/// What `light`, which has a response, makes of the colour of an even field where its gradient is at this
/// cosine to the eye; clamped, if it clamps.
Tint lit_tint(const volume::Light& light, double cosine, const Tint& even);

/// A ray, and values whose fields are translucent on it.
struct LitRay {
  double x = 0;  ///< normalised device coordinates
  double y = 0;
  WayThroughBox way;
  std::vector<float> values{};
  std::vector<volume::Rgba> even{};  ///< premultiplied: what fields of one value show
};

class SlopeProbe {
 public:
  SlopeProbe(const MarchContext& measured, FieldProbe& probe, const March& march);

  /// Premultiplied colours of the ray at (x, y) over fields of one value.
  std::vector<volume::Rgba> even(double x, double y, const std::vector<float>& values);

  /// Over fields that rise, per unit of texture space, by `gradient` times `steepness` times the least rise
  /// that tells; in the middle of the ray they have the value.
  std::vector<volume::Rgba> over(const LitRay& ray, const std::vector<float>& values,
                                 const volume::Vec3& gradient, double steepness = 1, int texels = slope_texels);
  /// Of the ray's own values.
  std::vector<volume::Rgba> over(const LitRay& ray, const volume::Vec3& gradient, double steepness = 1,
                                 int texels = slope_texels) {
    return over(ray, ray.values, gradient, steepness, texels);
  }

  /// By how much the values on a ray differ from that in its middle, over a slope so steep along it.
  float rise_along(double steepness) const;

  /// The ray's first value, on average over stripes of a width across `axis` (in FieldProbe::split_unit) that
  /// begin anywhere.
  Tint over_stripes(const LitRay& ray, std::size_t axis, int width);

  /// The ray with up to three values that it shows translucent, at no step of the table, and in colours that
  /// differ as much as they can.
  LitRay with_values(LitRay ray);

 private:
  std::vector<volume::Rgba> premultiplied_all(std::vector<volume::Rgba> fragments) const;
  /// Of all over the range of values.
  float least_rise() const;

  FieldProbe& probe_;
  bool premultiplied_;
  std::array<float, 2> range_;
};

/// Whether a ray's opacity is one whose colour tells.
bool is_translucent(const volume::Rgba& colour);

/// Rays that go far through the box: the longest, and others a little away from the middle of the view.
std::vector<LitRay> long_rays(const RaysThroughBox& rays, const volume::RaySteps& steps);

}  // namespace understudy::spu
