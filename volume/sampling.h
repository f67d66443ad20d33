// SPDX-License-Identifier: Apache-2.0
// Where the samples of a ray lie: on the planes of slices, or on constant steps along the ray.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "volume/texture_space.h"

namespace understudy::volume {

/// The application's own sample positions: planes normal . t = first + i * spacing in texture space, 0 <= i <
/// count. Plane 0 is the front: under `over`, sample i covers sample i + 1.
struct SlicePlanes {
  Vec3 normal{};
  double first = 0;
  double spacing = 0;
  int count = 0;
  bool operator==(const SlicePlanes&) const = default;
};

/// How far into its first step every ray begins, as a tile of numbers that repeats over the window: some ray
/// casters hide the rings of equal steps behind noise.
struct RayOffsets {
  int width = 0;
  int height = 0;
  std::vector<float> steps;  ///< rows bottom up

  double at(int x, int y) const {
    const auto column = std::size_t((x % width + width) % width);
    const auto row = std::size_t((y % height + height) % height);
    return double(steps[row * std::size_t(width) + column]);
  }
  bool operator==(const RayOffsets&) const = default;
};

/// The sample positions of a ray caster: constant steps along every ray, from where it enters the region. The
/// unit of length is the step: a ray that is in the region from t0 to t1 is L = |metric (t1 - t0)| steps long.
/// Sample i lies first + i steps from t0, i >= 0, up to L; where there are `offsets`, that of the pixel later.
struct RaySteps {
  /// Row-major; texture space to a space whose unit of length is the step. Or its first row alone, others zero:
  /// then steps reach from plane to plane, however slantingly a ray crosses them.
  std::array<double, 9> metric{};
  /// Whether steps reach from plane to plane.
  bool between_planes() const {
    return std::all_of(metric.begin() + 3, metric.end(), [](double v) { return v == 0; });
  }
  double first = 0;
  /// The ray is divided into n = floor(L + rounding) equal parts, n >= 1 (otherwise it has no samples, but for
  /// `at_least_one`); sample
  /// i lies first + i parts from t0, 0 <= i < n.
  bool divided = false;
  double rounding = 0.5;
  /// Samples up to so many steps behind the opaque geometry still count.
  double past_depth = 0;
  std::optional<RayOffsets> offsets;  ///< added to `first`, by pixel of the window
  /// There are as many samples as if the first lay so many steps from t0, wherever it lies: programs that count
  /// their samples before they take them, as ceil(L) from the middle of the first step. The last one may then
  /// lie beyond the region, where the field is what the texture's wrapping makes of it; the texture does not
  /// repeat, the region is all of it, and there are no clip planes. Null: samples lie up to L.
  std::optional<double> counted_from;
  /// Every ray that enters the region before the far plane and the opaque geometry has its first sample,
  /// wherever that lies: programs that look for the end of a ray only after a sample, as VTK's. Samples beyond
  /// the region as for `counted_from`. Where `divided`, a ray has one part at least.
  bool at_least_one = false;
  /// The samples stand for the whole of their ray (the midpoint rule): sample i for the step around it, the
  /// last one for all that is left, a half to one and a half steps, with the opacity and colour of that length.
  /// A ray shorter than a step has one sample, in its middle. Steps begin where the ray does, at a clip plane
  /// or the near plane if that cuts the region, and end before opaque geometry. `first` is 0.5, and none of
  /// `divided`, `past_depth`, `offsets`, `counted_from` and `at_least_one` is set. For post-classified samples
  /// of a transfer function under `over`, without fog, light or an opacity limit.
  bool cover_whole_ray = false;

  /// By so many steps, at most, do samples lie beyond the end of their ray.
  double beyond_end() const {
    const double within = most_within();
    double beyond = std::max(0.0, first - within);
    if (!offsets) return beyond;
    for (const float offset : offsets->steps) beyond = std::max(beyond, first + double(offset) - within);
    return beyond;
  }
  /// Whether any do.
  bool any_beyond_end() const {
    const double within = most_within();
    if (first > within) return true;
    return offsets && std::any_of(offsets->steps.begin(), offsets->steps.end(),
                                  [&](float offset) { return first + double(offset) > within; });
  }
  bool operator==(const RaySteps&) const = default;

 private:
  /// A first sample that lies so many steps in, or fewer, is within its ray.
  double most_within() const {
    if (at_least_one) return divided ? 1 : 0;
    return counted_from.value_or(std::numeric_limits<double>::infinity());
  }
};

/// Where the second sample of a segment lies, whose first one lies on its plane: so many plane spacings further
/// along the ray (0: none), and then away by a vector. It is not bound to the region, and may be anywhere that
/// the texture's wrapping (repetition aside) gives it a value.
struct SliceSegment {
  double planes = 0;
  Vec3 offset{};
  /// The two samples are nowhere further apart than this, axis by axis in texture space.
  Vec3 reach{};
  bool operator==(const SliceSegment&) const = default;
};

}  // namespace understudy::volume
