// SPDX-License-Identifier: Apache-2.0
// Rays over fields with a slope, and the values on them that reveal light.
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

/// Texels along each axis of a field with a slope; the field is constant within half a texel of both ends.
constexpr int slope_texels = 32;

Tint tint_of(const volume::Rgba& premultiplied);
std::vector<Tint> tints_of(const std::vector<volume::Rgba>& colours);
/// Returns the difference in the channel in which they differ most.
double difference(const Tint& a, const Tint& b);
/// The largest channel of all.
double brightest(const std::vector<Tint>& tints);

/// A ray, and values whose fields are translucent on it; or one value, in the middle of the range, that has
/// another colour under each of several plain tables. Under these, slopes may be of any steepness.
struct LitRay {
  double x = 0;  ///< normalised device coordinates
  double y = 0;
  WayThroughBox way;
  std::vector<float> values{};
  std::vector<volume::Rgba> base{};  ///< premultiplied: colours of the values, of which light gives multiples
  /// For each of `values`, all tables that are looked up by samples; empty: the program's own.
  std::vector<std::vector<FieldProbe::PlainTable>> tables{};
  double plain_opacity = 0;  ///< of one sample under any of the tables
};

class SlopeProbe {
 public:
  /// `march` must outlive the probe, and have steps and a table.
  SlopeProbe(const MarchContext& measured, FieldProbe& probe, const March& march);

  /// Returns premultiplied colours of the ray at (x, y) over constant fields.
  std::vector<volume::Rgba> even(double x, double y, const std::vector<float>& values);

  /// Returns the colours of which light gives multiples: these, or, if constant fields are black under the
  /// light of `march`, the table's.
  std::vector<volume::Rgba> base(double x, double y, const std::vector<float>& values);

  /// Returns what the ray shows over fields that rise, as the program's gradients see them, by `gradient` times
  /// `steepness` times the least measurable rise, per unit of texture space. Fields have their value at the
  /// mean place of the ray's samples, weighted by what is visible of them.
  std::vector<volume::Rgba> over(const LitRay& ray, const std::vector<float>& values,
                                 const volume::Vec3& gradient, double steepness, int texels = slope_texels) {
    return over(
        ray, values, {&gradient, 1}, [=](float, const volume::Vec3&) { return steepness; }, texels);
  }
  /// Likewise, as steep as each value's colours, and the march, allow. A program that keeps its normals from a
  /// division by zero, as by slope / (length(slope) + 1e-6), makes them shorter the gentler the slope is.
  std::vector<volume::Rgba> over_steep(const LitRay& ray, const std::vector<float>& values,
                                       const volume::Vec3& gradient, int texels = slope_texels) {
    return over_steep(ray, values, {&gradient, 1}, texels);
  }
  /// Likewise, gradient by gradient, all values of each; all are read back at once.
  std::vector<volume::Rgba> over_steep(const LitRay& ray, const std::vector<float>& values,
                                       std::span<const volume::Vec3> gradients, int texels = slope_texels) {
    return over(
        ray, values, gradients,
        [&](float value, const volume::Vec3& gradient) { return allowed_steepness(ray, value, gradient); },
        texels);
  }
  /// Returns the opacities of the ray's samples over such a field, from the eye on.
  std::vector<double> opacities_over(const LitRay& ray, float value, const volume::Vec3& gradient,
                                     double steepness, int texels = slope_texels) const;
  std::vector<double> opacities_over_steep(const LitRay& ray, float value, const volume::Vec3& gradient,
                                           int texels = slope_texels) const {
    return opacities_over(ray, value, gradient, allowed_steepness(ray, value, gradient), texels);
  }
  /// The largest steepness by which light is measured.
  double steepness() const { return march_.slope_steepness; }
  /// The steepness by which a value of the ray is probed over a gradient.
  double steepness_over(const LitRay& ray, float value, const volume::Vec3& gradient) const {
    return allowed_steepness(ray, value, gradient);
  }
  /// Whether a value's colours allow slopes as steep as the march does.
  bool allows_steep(const LitRay& ray, float value, const volume::Vec3& gradient) const {
    return allowed_steepness(ray, value, gradient) >= march_.slope_steepness;
  }
  /// The steepness that all values of the ray allow, at any angle.
  double allowed_steepness(const LitRay& ray) const;
  /// The opacity of one sample of a value, by the march's table.
  double sample_opacity(float value) const;
  /// Returns such a field as ray_normals.h has it; `reach` in texels of the volume, as volume::Light has it.
  EvenRise rise(const volume::Vec3& gradient, double steepness, const std::array<double, 3>& reach,
                int texels = slope_texels) const;

  /// Texels along the axis of fields that rise along one alone: so many that the first sample on a ray, which
  /// lies on a face, has the same normal as the others.
  int fine_texels() const { return counts_texels() ? 2 * slope_texels : probe_.finest_texels(); }

  /// By how much the values on a ray differ from the field's value, over the fields of over().
  float rise_along(const LitRay& ray, const volume::Vec3& gradient, double steepness) const;

  /// Returns how many texels of the volume along an axis `part` is, a part of texture space over which
  /// gradients reach in a field of stripes.
  double reach_in_stripes(std::size_t axis, double part) const;
  /// The inverse of reach_in_stripes().
  double part_of_stripes(std::size_t axis, double texels) const;
  /// Converts texels of the volume along an axis to texture space.
  double part_of_volume(std::size_t axis, double texels) const;
  /// By how much neighbouring stripes on the ray differ.
  double stripes_differ(const LitRay& ray) const;
  /// Returns the colour of the ray's first value, averaged over shifts of stripes of this width (in
  /// FieldProbe::split_unit) across `axis`.
  Tint over_stripes(const LitRay& ray, std::size_t axis, int width);

  /// Returns the ray with up to three values that are translucent on it, at no step of the table, in colours
  /// that differ as much as possible, and that allow steep slopes if the colours of such values differ enough.
  LitRay with_values(LitRay ray);

 private:
  std::vector<volume::Rgba> premultiplied_all(std::vector<volume::Rgba> fragments) const;
  /// The least measurable rise, as a difference of values.
  float least_rise() const;
  std::vector<volume::Rgba> over(const LitRay& ray, const std::vector<float>& values,
                                 std::span<const volume::Vec3> gradients,
                                 const std::function<double(float, const volume::Vec3&)>& steepness_for,
                                 int texels);
  struct SamplesOverRise {
    double value_at_entry = 0;
    std::vector<double> opacities;
  };
  /// For a field that rises by `rise_of_way` along the ray, and has its value where over() states.
  SamplesOverRise samples_over_rise(const LitRay& ray, float value, double rise_of_way) const;
  double sample_opacity(const LitRay& ray, float value) const;
  /// By the march's table.
  double allowed_steepness(const LitRay& ray, float value, const volume::Vec3& gradient) const;
  bool counts_texels() const { return neighbours_ == program::NeighbourDistance::in_texels; }
  std::array<int, 3> field_size(int texels) const;
  /// Returns what a field of this size must rise by for the program's gradients to see this rise.
  volume::Vec3 risen(const volume::Vec3& gradient, double steepness, const std::array<int, 3>& size) const;

  FieldProbe& probe_;
  const March& march_;
  bool premultiplied_;
  std::array<float, 2> range_;
  std::array<int, 3> size_;  ///< of the volume
  std::optional<program::NeighbourDistance> neighbours_;
};

/// Whether a ray's opacity is one at which its colour can be measured.
bool is_translucent(const volume::Rgba& colour);

/// Returns rays that go far through the box: the one through the middle of the view, and others 3/4 and 1/2 as
/// long.
std::vector<LitRay> long_rays(const RaysThroughBox& rays, const volume::RaySteps& steps);

/// Returns rays that are a quarter and an eighth as long as the one through the middle of the view: these let
/// light through where all values are dense.
std::vector<LitRay> brief_rays(const RaysThroughBox& rays, const volume::RaySteps& steps);

/// Returns, of the rays a quarter as long as the one through the middle of the view, the one nearest to the eye
/// and the one farthest from it. (A long ray shows mostly what is near.)
std::vector<LitRay> near_and_far_rays(const RaysThroughBox& rays, const volume::RaySteps& steps,
                                      const volume::Matrix4& texture_to_clip);

}  // namespace understudy::spu
