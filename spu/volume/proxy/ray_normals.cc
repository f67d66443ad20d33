// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ray_normals.h"

#include <algorithm>
#include <cmath>

#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Vec3;

Vec3 seen_gradient(const EvenRise& field, const Vec3& place) {
  Vec3 seen{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double end = 0.5 / field.texels[axis];
    const double ahead = std::clamp(place[axis] + field.reach[axis], end, 1 - end);
    const double behind = std::clamp(place[axis] - field.reach[axis], end, 1 - end);
    seen[axis] = field.gradient[axis] * (ahead - behind) / (2 * field.reach[axis]);
  }
  return seen;
}

std::vector<NormalShare> ray_normals(const WayThroughBox& way, const volume::RaySteps& steps,
                                     std::span<const double> opacities, const LightSpace& space,
                                     const EvenRise& field, const volume::NormalGuard& guard) {
  constexpr double same = 1e-6;
  const std::vector<double> places = places_on_way(steps, way.way);
  std::vector<NormalShare> normals;
  double through = 1;
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double seen = through * opacities[i];
    through -= seen;
    const Vec3 place = volume::add(way.entry, volume::scale(way.way, places[i]));
    const Vec3 gradient = seen_gradient(field, place);
    NormalShare one{std::nullopt, seen};
    if (volume::length(gradient) > 0)
      one.cosine = space.cosine(gradient) * guard.length_of_normal(space.slope(gradient));
    const bool as_before = !normals.empty() && one.cosine.has_value() == normals.back().cosine.has_value() &&
                           (!one.cosine || std::abs(*one.cosine - *normals.back().cosine) < same);
    if (as_before)
      normals.back().share += seen;
    else
      normals.push_back(one);
    sum += seen;
  }
  for (NormalShare& normal : normals) normal.share /= sum;
  return normals;
}

Tint lit_tint(const volume::Light& light, const std::optional<double>& cosine, const Tint& base) {
  Tint lit;
  if (!cosine) {
    for (std::size_t c = 0; c < 3; ++c) lit[c] = double(light.even[c]) * base[c];
    return lit;
  }
  // Entries are so dense that the nearest one suffices.
  const double place = (std::clamp(*cosine, -1.0, 1.0) + 1) / 2 * double(light.response.size() - 1);
  const volume::LightResponse& response = light.response[std::size_t(std::lround(place))];
  for (std::size_t c = 0; c < 3; ++c)
    lit[c] =
        std::min((double(light.ambient[c]) + double(light.diffuse[c]) * double(response.diffuse)) * base[c] +
                     double(light.specular[c]) * double(response.specular),
                 double(light.brightest));
  return lit;
}

Tint lit_tint(const volume::Light& light, const std::vector<NormalShare>& normals, const Tint& base) {
  Tint mean{};
  for (const NormalShare& normal : normals) {
    const Tint lit = lit_tint(light, normal.cosine, base);
    for (std::size_t c = 0; c < 3; ++c) mean[c] += normal.share * lit[c];
  }
  return mean;
}

}  // namespace understudy::spu
