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

}  // namespace

LightSpace::LightSpace(const std::array<double, 9>& space, const Vec3& way) : space_(space) {
  to_eye_ = unit({-volume::dot(row_of(0), way), -volume::dot(row_of(1), way), -volume::dot(row_of(2), way)});
  const auto least = std::size_t(std::ranges::min_element(to_eye_, {}, [](double v) { return std::abs(v); }) -
                                 to_eye_.begin());
  Vec3 axis{};
  axis[least] = 1;
  right_ = unit(volume::cross(to_eye_, axis));
  up_ = volume::cross(to_eye_, right_);
}

Vec3 LightSpace::gradient(double angle, double turn) const {
  Vec3 normal{};
  for (std::size_t i = 0; i < 3; ++i)
    normal[i] =
        std::cos(angle) * to_eye_[i] + std::sin(angle) * (std::cos(turn) * right_[i] + std::sin(turn) * up_[i]);
  // Gradients are covectors: they come back to texture space by the transpose.
  Vec3 gradient{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) gradient[k] -= space_[3 * i + k] * normal[i];
  const double largest = std::max({std::abs(gradient[0]), std::abs(gradient[1]), std::abs(gradient[2])});
  return volume::scale(gradient, 1 / largest);
}

double LightSpace::cosine_across(std::size_t axis) const {
  const Vec3 a = row_of(0);
  const Vec3 b = row_of(1);
  const Vec3 c = row_of(2);
  // And they go to the space by the inverse's transpose, here but for the sign of the determinant.
  const double sign = volume::dot(a, volume::cross(b, c)) < 0 ? -1 : 1;
  const Vec3 gradient{sign * volume::cross(b, c)[axis], sign * volume::cross(c, a)[axis],
                      sign * volume::cross(a, b)[axis]};
  return -volume::dot(unit(gradient), to_eye_);
}

}  // namespace understudy::spu
