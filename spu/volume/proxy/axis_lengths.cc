// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/axis_lengths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "volume/matrix.h"

namespace understudy::spu {

// The linear part of the matrix is K R E: E holds the edge lengths, R is a rotation, and K scales x and y alike
// (once they are counted in pixels) and depth by another factor. With q_ij = x_i x_j + y_i y_j and d the depth
// row, q_ij + k d_i d_j is 0 for two different edges, which gives k; for i = j it is the squared length of an
// edge.
std::optional<volume::Vec3> axis_lengths(const volume::Matrix4& texture_to_clip, int width, int height) {
  constexpr double along_axis = 1e-3;  // least product of depths that determines the lengths
  constexpr double oblique = 1e-3;     // cosine
  const auto row = [&](std::size_t index, double factor) {
    return volume::Vec3{factor * texture_to_clip[4 * index], factor * texture_to_clip[4 * index + 1],
                        factor * texture_to_clip[4 * index + 2]};
  };
  const volume::Vec3 x = row(0, width);
  const volume::Vec3 y = row(1, height);
  // In perspective, w is the depth in front of the eye; in a parallel projection it is constant.
  volume::Vec3 depth = row(3, 1);
  if (volume::length(depth) == 0) depth = row(2, 1);
  const double deepest = volume::length(depth);
  if (!(deepest > 0)) return std::nullopt;
  depth = volume::scale(depth, 1 / deepest);

  constexpr std::array<std::pair<std::size_t, std::size_t>, 3> pairs{{{0, 1}, {0, 2}, {1, 2}}};
  const auto across = [&](std::size_t i, std::size_t j) { return x[i] * x[j] + y[i] * y[j]; };
  double product = 0;
  double square = 0;
  for (const auto& [i, j] : pairs) {
    const double both = depth[i] * depth[j];
    product -= across(i, j) * both;
    square += both * both;
  }
  if (!(square > along_axis * along_axis)) return std::nullopt;
  const double k = product / square;
  volume::Vec3 lengths{};
  for (std::size_t i = 0; i < 3; ++i) lengths[i] = std::sqrt(across(i, i) + k * depth[i] * depth[i]);
  for (const auto& [i, j] : pairs) {
    if (!(std::abs(across(i, j) + k * depth[i] * depth[j]) <= oblique * lengths[i] * lengths[j]))
      return std::nullopt;
  }
  return volume::scale(lengths, 1 / std::max({lengths[0], lengths[1], lengths[2]}));
}

}  // namespace understudy::spu
