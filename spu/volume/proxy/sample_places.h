// SPDX-License-Identifier: Apache-2.0
// Where the samples of a ray lie, measured with fields of two values that meet at a plane, by the number of
// samples in front of it. Constant fields show how many samples there are, but not where.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/sampling.h"

namespace understudy::spu {

struct March;

/// The ray of one pixel through such a field.
struct SplitRay {
  std::array<double, 2> place{};  ///< in normalised device coordinates
  int x = 0;                      ///< the pixel, in the window
  int y = 0;
  double samples = 0;  ///< on the whole ray
  double before = 0;   ///< where the field has its first value; not whole if a sample shows both values
};

/// Rays all over the box, through one field.
struct SplitRays {
  FieldProbe::SplitField field;
  std::vector<SplitRay> rays;
};

/// A value of a constant field, and what a long ray through it shows.
struct SeenValue {
  float value = 0;
  volume::Rgba ray{};
};

/// Bands of two rows each, in which rays are counted.
struct SplitBands {
  int number = 12;  ///< evenly spread over the viewport, as wide as it is
  /// In place of these, one band of at most this many columns that crosses the middle of the box; 0: none.
  int columns_of_middle = 0;
  double height_of_middle = 0.5;  ///< 0 to 1: where it crosses, between a quarter and three of the box's height
  bool across_all_axes = true;    ///< false: only planes perpendicular to the axis along which rays go farthest
};

std::vector<SeenValue> seen_values(const std::vector<float>& values, const std::vector<volume::Rgba>& rays);

/// Returns fields whose planes most rays cross, inside both the box and the texture; empty if these do not
/// overlap. `way`: the path of a ray through the box's middle.
std::vector<FieldProbe::SplitField> split_fields(const volume::Box& box, const volume::Vec3& way, float before,
                                                 float behind);

/// Returns rays through fields of march.translucent and another of `values`. Empty if no other value can be
/// told apart, or if there are too few rays.
std::vector<SplitRays> split_rays(const MarchContext& measured, FieldProbe& probe, const March& march,
                                  const ProxyBox& box, const std::vector<SeenValue>& values,
                                  const SplitBands& bands = {});

/// Returns the fraction of rays whose samples lie elsewhere than `steps` places them, for planes perpendicular
/// to the axis with the largest fraction. Rays that show nothing of it do not count. Null if too few rays
/// remain.
std::optional<double> misplaced_part(const std::vector<SplitRays>& split, const RaysThroughBox& rays,
                                     const volume::RaySteps& steps);

/// The fraction that rounding misplaces where planes fall on samples.
constexpr double misplaced_by_rounding = 0.02;

/// A larger fraction of misplaced rays is not due to rounding.
constexpr double most_misplaced = 0.1;

}  // namespace understudy::spu
