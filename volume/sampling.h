// SPDX-License-Identifier: Apache-2.0
// Where the samples of a ray lie: on slice planes, or at constant steps along the ray.
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
/// count. Plane 0 is in front: under `over`, sample i covers sample i + 1.
struct SlicePlanes {
  Vec3 normal{};
  double first = 0;
  double spacing = 0;
  int count = 0;
  bool operator==(const SlicePlanes&) const = default;
};

/// Offset of every ray's first sample, in steps, as a tile of values repeated over the window (jittering): some
/// ray casters hide the rings caused by equal steps behind noise.
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
/// unit of length is the step: a ray inside the region from t0 to t1 is L = |metric (t1 - t0)| steps long.
/// Sample i lies first + i steps from t0, i >= 0, up to L, plus the pixel's offset if there are `offsets`.
struct RaySteps {
  /// Row-major; from texture space to a space whose unit of length is the step. If only the first row is not
  /// zero, steps are measured between parallel planes, independently of the angle at which a ray crosses them.
  std::array<double, 9> metric{};
  /// Whether steps are measured between planes.
  bool between_planes() const {
    return std::all_of(metric.begin() + 3, metric.end(), [](double v) { return v == 0; });
  }
  double first = 0;
  /// If true, the ray is divided into n = floor(L + rounding) equal parts. Rays with n < 1 have no samples,
  /// except with `at_least_one`. Sample i lies first + i parts from t0, 0 <= i < n.
  bool divided = false;
  double rounding = 0.5;
  /// Samples up to this many steps behind the opaque geometry still count.
  double past_depth = 0;
  std::optional<RayOffsets> offsets;  ///< added to `first`, by pixel of the window
  /// The number of samples is what it would be if the first lay this many steps from t0, wherever it does lie:
  /// for programs that compute the number of samples in advance, as ceil(L) from the middle of the first step.
  /// The last sample may then lie beyond the region, where the field is defined by the texture's wrapping; the
  /// texture must not repeat, nor have a border under a nearest filter, the region must be all of it, and there
  /// must be no clip planes. Unset: samples lie up to L.
  std::optional<double> counted_from;
  /// Every ray that enters the region before the far plane and the opaque geometry has a first sample, even if
  /// it lies beyond the region: for programs that test for the end of a ray only after a sample, like VTK's.
  /// The restrictions of `counted_from` apply. With `divided`, a ray has at least one part.
  bool at_least_one = false;
  /// The samples represent their whole ray (midpoint rule): each represents the step around it, and the last
  /// one the rest of the ray, 0.5 to 1.5 steps, with the opacity and colour of that length. A ray shorter than
  /// a step has one sample, in its middle. Steps begin at the start of the ray, or where a clip plane or the
  /// near plane cuts the region, and end before opaque geometry. `first` must be 0.5, and none of `divided`,
  /// `past_depth`, `offsets`, `counted_from` and `at_least_one` may be set. For post-classified samples of a
  /// transfer function under `over`, without fog, light, surfaces or an opacity limit.
  bool cover_whole_ray = false;

  /// How far samples lie beyond the end of their ray at most, in steps.
  double beyond_end() const {
    const double within = most_within();
    double beyond = std::max(0.0, first - within);
    if (!offsets) return beyond;
    for (const float offset : offsets->steps) beyond = std::max(beyond, first + double(offset) - within);
    return beyond;
  }
  /// Whether any sample lies beyond the end of its ray.
  bool any_beyond_end() const {
    const double within = most_within();
    if (first > within) return true;
    return offsets && std::any_of(offsets->steps.begin(), offsets->steps.end(),
                                  [&](float offset) { return first + double(offset) > within; });
  }
  bool operator==(const RaySteps&) const = default;

 private:
  /// A first sample at most this many steps from the entry lies within its ray.
  double most_within() const {
    if (at_least_one) return divided ? 1 : 0;
    return counted_from.value_or(std::numeric_limits<double>::infinity());
  }
};

/// The position of the second sample of a slice segment, relative to the first one on its plane: `planes` plane
/// spacings further along the ray (0: none), plus `offset`. It is not limited to the region: it may be anywhere
/// that the texture's wrapping, except repetition and a border under a nearest filter, defines a value.
struct SliceSegment {
  double planes = 0;
  Vec3 offset{};
  /// Upper bound of the distance between the two samples, per axis, in texture space.
  Vec3 reach{};
  bool operator==(const SliceSegment&) const = default;
};

}  // namespace understudy::volume
