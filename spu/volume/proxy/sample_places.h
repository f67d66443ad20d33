// SPDX-License-Identifier: Apache-2.0
// Where the samples of a ray lie, told by fields of two values that meet at a plane: how many samples lie
// before it. Fields of one value tell how many samples there are, and not where.
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
  double samples = 0;  ///< on all of it
  double before = 0;   ///< where the field has its first value; no whole number where a sample shows both
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

/// Bands of two rows each.
struct SplitBands {
  int number = 12;
  bool halves = false;          ///< of rows, left and right in turn: rays of all lengths, half as many
  bool across_all_axes = true;  ///< false: the planes lie across the axis along which rays go farthest
};

std::vector<SeenValue> seen_values(const std::vector<float>& values, const std::vector<volume::Rgba>& rays);

/// Fields whose planes most rays cross, in the box's inside and the texture's; none where these do not meet.
/// `way`: of a ray through the box's middle.
std::vector<FieldProbe::SplitField> split_fields(const volume::Box& box, const volume::Vec3& way, float before,
                                                 float behind);

/// Under fields of march.translucent and another of `values`. None where no other value tells, or too few rays.
std::vector<SplitRays> split_rays(const MarchContext& measured, FieldProbe& probe, const March& march,
                                  const ProxyBox& box, const std::vector<SeenValue>& values,
                                  const SplitBands& bands = {});

/// The part of the rays whose samples lie elsewhere than `steps` says, of those through planes across the axis
/// along which most do; rays that tell nothing do not count. None
/// where too few tell.
std::optional<double> misplaced_part(const std::vector<SplitRays>& split, const RaysThroughBox& rays,
                                     const volume::RaySteps& steps);

/// So many lie elsewhere where planes fall on samples.
constexpr double misplaced_by_rounding = 0.02;

/// More misplaced rays than that are no rounding.
constexpr double most_misplaced = 0.1;

}  // namespace understudy::spu
