// SPDX-License-Identifier: Apache-2.0
// Rays over fields with a slope, and the values on them that tell what light does.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/ray_normals.h"
#include "volume/light.h"

namespace understudy::spu {

/// Texels along each axis of a field with a slope: at both ends half a texel is even.
constexpr int slope_texels = 32;

Tint tint_of(const volume::Rgba& premultiplied);
std::vector<Tint> tints_of(const std::vector<volume::Rgba>& colours);
/// In the channel in which they differ most.
double difference(const Tint& a, const Tint& b);
/// The largest channel of all.
double brightest(const std::vector<Tint>& tints);

/// A ray, and values whose fields are translucent on it; or one value, in the middle of the range, that has
/// another colour under each of several tables of one colour. Under these slopes may be as steep as one likes.
struct LitRay {
  double x = 0;  ///< normalised device coordinates
  double y = 0;
  WayThroughBox way;
  std::vector<float> values{};
  std::vector<volume::Rgba> base{};  ///< premultiplied: the colours of the values that light gives multiples of
  /// For each of `values`, all that are looked up by samples; empty: the program's own.
  std::vector<std::vector<FieldProbe::PlainTable>> tables{};
  double plain_opacity = 0;  ///< of one sample under any of the tables
};

class SlopeProbe {
 public:
  /// `march` stays, and has steps and a table.
  SlopeProbe(const MarchContext& measured, FieldProbe& probe, const March& march);

  /// Premultiplied colours of the ray at (x, y) over fields of one value.
  std::vector<volume::Rgba> even(double x, double y, const std::vector<float>& values);

  /// What light gives multiples of: these, or, where even fields are black under the light of `march`, the
  /// table's colours.
  std::vector<volume::Rgba> base(double x, double y, const std::vector<float>& values);

  /// Over fields that rise, as the program's gradients see them, by `gradient` times `steepness` times the
  /// least rise that tells, per unit of texture space. Their values are met where a ray is seen, on average
  /// over its samples.
  std::vector<volume::Rgba> over(const LitRay& ray, const std::vector<float>& values,
                                 const volume::Vec3& gradient, double steepness, int texels = slope_texels) {
    return over(
        ray, values, {&gradient, 1}, [=](float, const volume::Vec3&) { return steepness; }, texels);
  }
  /// The same as steep as each value's colours allow, and the march: a program that keeps its normals from a
  /// division by zero, as by slope / (length(slope) + 1e-6), makes them shorter the gentler the slope is.
  std::vector<volume::Rgba> over_steep(const LitRay& ray, const std::vector<float>& values,
                                       const volume::Vec3& gradient, int texels = slope_texels) {
    return over_steep(ray, values, {&gradient, 1}, texels);
  }
  /// Gradient by gradient, all values of each: what is seen of all is read at once.
  std::vector<volume::Rgba> over_steep(const LitRay& ray, const std::vector<float>& values,
                                       std::span<const volume::Vec3> gradients, int texels = slope_texels) {
    return over(
        ray, values, gradients,
        [&](float value, const volume::Vec3& gradient) { return allowed_steepness(ray, value, gradient); },
        texels);
  }
  /// Opacities of the ray's samples over such a field, from the eye on.
  std::vector<double> opacities_over(const LitRay& ray, float value, const volume::Vec3& gradient,
                                     double steepness, int texels = slope_texels) const;
  std::vector<double> opacities_over_steep(const LitRay& ray, float value, const volume::Vec3& gradient,
                                           int texels = slope_texels) const {
    return opacities_over(ray, value, gradient, allowed_steepness(ray, value, gradient), texels);
  }
  /// By which the light is measured, at most.
  double steepness() const { return march_.slope_steepness; }
  /// By which a value of the ray is looked at over a gradient.
  double steepness_over(const LitRay& ray, float value, const volume::Vec3& gradient) const {
    return allowed_steepness(ray, value, gradient);
  }
  /// Whether a value's colours allow as steep slopes as the march does.
  bool allows_steep(const LitRay& ray, float value, const volume::Vec3& gradient) const {
    return allowed_steepness(ray, value, gradient) >= march_.slope_steepness;
  }
  /// As steep as all values of the ray allow, at any angle.
  double allowed_steepness(const LitRay& ray) const;
  /// Of one sample of a value, by the march's table.
  double sample_opacity(float value) const;
  /// The same fields as ray_normals.h has them; `reach` in texels of the volume, as volume::Light has it.
  EvenRise rise(const volume::Vec3& gradient, double steepness, const std::array<double, 3>& reach,
                int texels = slope_texels) const;

  /// Along the axis of fields that rise along one alone: so many that the first sample on a ray, which lies on
  /// a face, has the others' normal.
  int fine_texels() const { return counts_texels() ? 2 * slope_texels : probe_.finest_texels(); }

  /// By how much the values on a ray differ from that of the field, over the fields of over().
  float rise_along(const LitRay& ray, const volume::Vec3& gradient, double steepness) const;

  /// How many of the volume's texels along an axis a part of texture space is that gradients reach over in a
  /// field of stripes.
  double reach_in_stripes(std::size_t axis, double part) const;
  /// So many of the volume's texels in texture space.
  double part_of_volume(std::size_t axis, double texels) const;
  /// By how much neighbouring stripes on the ray differ.
  double stripes_differ(const LitRay& ray) const;
  /// The ray's first value, on average over stripes of a width across `axis` (in FieldProbe::split_unit) that
  /// begin anywhere.
  Tint over_stripes(const LitRay& ray, std::size_t axis, int width);

  /// The ray with up to three values that it shows translucent, at no step of the table, in colours that differ
  /// as much as they can, and that allow steep slopes if such values have colours that differ enough.
  LitRay with_values(LitRay ray);

 private:
  std::vector<volume::Rgba> premultiplied_all(std::vector<volume::Rgba> fragments) const;
  /// Of all over the range of values.
  float least_rise() const;
  std::vector<volume::Rgba> over(const LitRay& ray, const std::vector<float>& values,
                                 std::span<const volume::Vec3> gradients,
                                 const std::function<double(float, const volume::Vec3&)>& steepness_for,
                                 int texels);
  struct SamplesOverRise {
    double value_at_entry = 0;
    std::vector<double> opacities;
  };
  /// Of a field that rises by so much along the ray, and is met as over() says.
  SamplesOverRise samples_over_rise(const LitRay& ray, float value, double rise_of_way) const;
  double sample_opacity(const LitRay& ray, float value) const;
  /// By the march's table.
  double allowed_steepness(const LitRay& ray, float value, const volume::Vec3& gradient) const;
  bool counts_texels() const { return neighbours_ == program::NeighbourDistance::in_texels; }
  std::array<int, 3> field_size(int texels) const;
  /// What a field of this size rises by, so that the program's gradients see this.
  volume::Vec3 risen(const volume::Vec3& gradient, double steepness, const std::array<int, 3>& size) const;

  FieldProbe& probe_;
  const March& march_;
  bool premultiplied_;
  std::array<float, 2> range_;
  std::array<int, 3> size_;  ///< of the volume
  std::optional<program::NeighbourDistance> neighbours_;
};

/// Whether a ray's opacity is one whose colour tells.
bool is_translucent(const volume::Rgba& colour);

/// Rays that go far through the box: the longest, and others a little away from the middle of the view.
std::vector<LitRay> long_rays(const RaysThroughBox& rays, const volume::RaySteps& steps);

/// Rays that are a quarter and an eighth as long as the one through the middle of the view: where all values
/// are dense, these let light through.
std::vector<LitRay> brief_rays(const RaysThroughBox& rays, const volume::RaySteps& steps);

/// Of the rays a quarter as long as the one through the middle of the view, that which is nearest to the eye
/// and that which is farthest from it. A long ray shows mostly what is near.
std::vector<LitRay> near_and_far_rays(const RaysThroughBox& rays, const volume::RaySteps& steps,
                                      const volume::Matrix4& texture_to_clip);

}  // namespace understudy::spu
