// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/slice_segment.h"

#include <algorithm>
#include <cmath>

#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::Vec3;

/// Precision of coordinates: floats in [0,1], and what a vertex shader adds to them.
constexpr double same_coordinate = 4e-6;
/// A second sample further away than this is not the end of a segment.
constexpr double longest = 0.25;

/// The first coordinate, and the offset from it to the second.
struct Way {
  Vec3 from;
  Vec3 to;
};

std::vector<Way> ways_to(const Capture& capture, std::span<const ObservedVertex> vertices, std::size_t input) {
  std::vector<Way> ways;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    Way way{vertices[v].texture, {}};
    for (std::size_t k = 0; k < 3; ++k) way.to[k] = double(capture.value(v, input, k)) - way.from[k];
    ways.push_back(way);
  }
  return ways;
}

bool all_near(const std::vector<Way>& ways, const auto& expected) {
  return std::all_of(ways.begin(), ways.end(), [&](const Way& way) {
    const Vec3 there = expected(way);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(std::abs(way.to[k] - there[k]) <= same_coordinate)) return false;
    }
    return true;
  });
}

/// Returns the segment if all offsets are one vector, or one number of planes along the ray from `eye`
/// (homogeneous).
std::optional<volume::SliceSegment> slice_segment_of(const std::vector<Way>& ways,
                                                     const volume::SlicePlanes& planes,
                                                     const volume::Vec4& eye) {
  volume::SliceSegment slice_segment;
  double planes_between = 0;
  for (const Way& way : ways) {
    planes_between += volume::dot(planes.normal, way.to) / planes.spacing;
    for (std::size_t k = 0; k < 3; ++k) {
      slice_segment.offset[k] += way.to[k];
      slice_segment.reach[k] = std::max(slice_segment.reach[k], std::abs(way.to[k]) + same_coordinate);
    }
  }
  for (double& component : slice_segment.offset) component /= double(ways.size());
  if (*std::max_element(slice_segment.reach.begin(), slice_segment.reach.end()) > longest) return std::nullopt;
  if (all_near(ways, [&](const Way&) { return slice_segment.offset; })) return slice_segment;

  slice_segment.offset = {};
  slice_segment.planes = planes_between / double(ways.size());
  const auto along_ray = [&](const Way& way) {
    Vec3 ray{};
    for (std::size_t k = 0; k < 3; ++k) ray[k] = eye[3] * way.from[k] - eye[k];
    return volume::scale(ray, slice_segment.planes * planes.spacing / volume::dot(planes.normal, ray));
  };
  if (all_near(ways, along_ray)) return slice_segment;
  return std::nullopt;
}

}  // namespace

std::vector<ObservedSegment> find_slice_segments(const Capture& capture,
                                                 std::span<const ObservedVertex> vertices,
                                                 const std::vector<StageInput>& inputs, const SliceSet& slices,
                                                 const CameraFit& camera) {
  std::vector<ObservedSegment> slice_segments;
  const auto clip_to_texture = volume::inverse(camera.texture_to_clip);
  if (!clip_to_texture) return slice_segments;
  const volume::Vec4 eye = volume::transform(*clip_to_texture, {0, 0, 1, 0});
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const StageInput& input = inputs[i];
    if (input.name == capture.coordinate || input.integer || !input.written || input.components < 3) continue;
    if (const auto slice_segment = slice_segment_of(ways_to(capture, vertices, i), slices.planes, eye))
      slice_segments.push_back({i, *slice_segment});
  }
  return slice_segments;
}

}  // namespace understudy::spu
