// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/light_space.h"

#include <algorithm>
#include <cmath>

#include "volume/matrix.h"

namespace understudy::spu {

using volume::Vec3;

namespace {

Vec3 unit(const Vec3& v) {
  return volume::scale(v, 1 / volume::length(v));
}

Vec3 row_of(const std::array<double, 9>& matrix, std::size_t row) {
  return {matrix[3 * row], matrix[3 * row + 1], matrix[3 * row + 2]};
}

}  // namespace

LightSpace::LightSpace(const volume::Light& light, const Vec3& way) : space_(light.space) {
  const std::array<double, 9> rays = light.ray_space.value_or(light.space);
  to_eye_ = unit({-volume::dot(row_of(rays, 0), way), -volume::dot(row_of(rays, 1), way),
                  -volume::dot(row_of(rays, 2), way)});
  const auto least = std::size_t(std::ranges::min_element(to_eye_, {}, [](double v) { return std::abs(v); }) -
                                 to_eye_.begin());
  Vec3 axis{};
  axis[least] = 1;
  right_ = unit(volume::cross(to_eye_, axis));
  up_ = volume::cross(to_eye_, right_);
  // Gradients transform to the space by the inverse transpose, here up to the determinant's magnitude.
  const Vec3 a = row_of(space_, 0);
  const Vec3 b = row_of(space_, 1);
  const Vec3 c = row_of(space_, 2);
  determinant_ = volume::dot(a, volume::cross(b, c));
  const double sign = determinant_ < 0 ? 1 : -1;
  for (std::size_t k = 0; k < 3; ++k)
    normals_[k] = volume::scale({volume::cross(b, c)[k], volume::cross(c, a)[k], volume::cross(a, b)[k]}, sign);
}

Vec3 LightSpace::gradient(double angle, double turn) const {
  Vec3 normal{};
  for (std::size_t i = 0; i < 3; ++i)
    normal[i] =
        std::cos(angle) * to_eye_[i] + std::sin(angle) * (std::cos(turn) * right_[i] + std::sin(turn) * up_[i]);
  // Gradients are covectors: they transform back to texture space by the transpose.
  Vec3 gradient{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) gradient[k] -= space_[3 * i + k] * normal[i];
  const double largest = std::max({std::abs(gradient[0]), std::abs(gradient[1]), std::abs(gradient[2])});
  return volume::scale(gradient, 1 / largest);
}

Vec3 LightSpace::normal(const Vec3& gradient) const {
  Vec3 normal{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    normal = volume::add(normal, volume::scale(normals_[axis], gradient[axis]));
  return normal;
}

double LightSpace::cosine(const Vec3& gradient) const {
  return volume::dot(unit(normal(gradient)), to_eye_);
}

double LightSpace::slope(const Vec3& gradient) const {
  return volume::length(normal(gradient)) / std::abs(determinant_);
}

}  // namespace understudy::spu
