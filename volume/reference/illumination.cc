// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/illumination.h"

#include <algorithm>
#include <cmath>

#include "volume/matrix.h"

namespace understudy::volume {
namespace {

Vec3 unit(const Vec3& v) {
  const double l = length(v);
  return l > 0 ? scale(v, 1 / l) : Vec3{};
}

Matrix4 linear(const std::array<double, 9>& m) {
  return {m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, 0, 0, 0, 1};
}

}  // namespace

Vec3 texel_gradient(const Field& field, const VolumeDescription& volume, const Vec3& t, const Vec3& reach) {
  Vec3 gradient{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double texel = 1.0 / volume.size[axis];
    const auto beside = [&](double texels) {
      Vec3 p = t;
      p[axis] += texels * texel;
      if (volume.wrap[axis] == Wrap::repeat) p[axis] = std::clamp(p[axis], -0.5 * texel, 1 + 0.5 * texel);
      return field(p)[0];
    };
    gradient[axis] = (beside(reach[axis]) - beside(-reach[axis])) / (2 * reach[axis]);
  }
  return gradient;
}

std::array<double, 4> illuminated(const Field& field, const VolumeDescription& volume, const Light& light,
                                  const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
  Vec3 gradient = texel_gradient(field, volume, t, light.reach);
  for (std::size_t axis = 0; axis < 3; ++axis) gradient[axis] *= volume.size[axis];
  const Matrix4 space = linear(light.space);
  const Matrix4 back = inverse(space).value();
  // Gradients transform by the transposed inverse.
  Vec3 normal{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k) normal[row] -= back[4 * k + row] * gradient[k];
  const double slope = length(normal);
  std::array<double, 4> even = colour;
  for (std::size_t k = 0; k < 3; ++k) even[k] *= double(light.even[k]);
  const auto faded = [&](std::array<double, 4> shown) {
    if (light.gradient_opacity.factors.empty()) return shown;
    for (double& channel : shown) channel *= light.gradient_opacity.at(slope);
    return shown;
  };
  if (!(slope > 0)) return faded(even);
  normal = scale(normal, 1 / slope);
  const Vec4 forward = transform(linear(light.ray_space.value_or(light.space)), {way[0], way[1], way[2], 0});
  const Vec3 eye = unit({-forward[0], -forward[1], -forward[2]});
  const Vec3 to_light = length(light.direction) > 0 ? unit(light.direction) : eye;
  normal = scale(normal, light.guard.length_of_normal(slope));
  const auto cosine = [&](const Vec3& direction) {
    const double c = dot(normal, direction);
    return light.two_sided ? std::abs(c) : std::max(c, 0.0);
  };
  double diffuse = cosine(to_light);
  double gleam = std::pow(cosine(unit(add(to_light, eye))), double(light.shininess));
  if (!light.response.empty()) {
    const double last = double(light.response.size() - 1);
    const double place = std::clamp((dot(normal, eye) + 1) / 2 * last, 0.0, last);
    const std::size_t entry = std::min(std::size_t(place), light.response.size() - 2);
    const LightResponse &below = light.response[entry], &above = light.response[entry + 1];
    const double share = place - double(entry);
    diffuse = double(below.diffuse) + share * (double(above.diffuse) - double(below.diffuse));
    gleam = double(below.specular) + share * (double(above.specular) - double(below.specular));
  }
  std::array<double, 4> lit = colour;
  for (std::size_t k = 0; k < 3; ++k)
    lit[k] = (double(light.ambient[k]) + double(light.diffuse[k]) * diffuse) * colour[k] +
             double(light.specular[k]) * gleam * colour[3];
  if (std::isfinite(light.brightest))
    for (std::size_t k = 0; k < 3; ++k) lit[k] = std::min(lit[k], double(light.brightest) * colour[3]);
  // Fades while `slope` is less than light.full_slope.
  const double share = slope < double(light.full_slope) ? slope / double(light.full_slope) : 1;
  for (std::size_t k = 0; k < 3; ++k) lit[k] = even[k] + share * (lit[k] - even[k]);
  return faded(lit);
}

}  // namespace understudy::volume
