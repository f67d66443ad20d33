// SPDX-License-Identifier: Apache-2.0
#include "volume/visibility_order.h"

#include <stdexcept>

#include "volume/request.h"

namespace understudy::volume {

namespace {

/// The centre of the region, or its deepest corner when the centre lies behind the eye.
Vec3 seen_point(const RenderRequest& request) {
  const auto depth = [&](const Vec3& t) { return transform_point(request.texture_to_clip, t)[3]; };
  const Box& region = request.region;
  Vec3 point = scale(add(region.low, region.high), 0.5);
  if (depth(point) > 0) return point;
  for (int axis = 0; axis < 3; ++axis)
    point[axis] = request.texture_to_clip[12 + axis] > 0 ? region.high[axis] : region.low[axis];
  return point;
}

}  // namespace

VisibilityOrder::VisibilityOrder(const Matrix4& texture_to_clip) {
  const auto clip_to_texture = inverse(texture_to_clip);
  if (!clip_to_texture) throw std::invalid_argument("the matrix from texture to clip space is singular");
  const Vec4 column = transform(*clip_to_texture, {0, 0, 1, 0});
  eye_ = {-column[0], -column[1], -column[2], -column[3]};
}

VisibilityOrder::VisibilityOrder(const RenderRequest& request) : VisibilityOrder(request.texture_to_clip) {
  if (request.steps) return;  // steps are ordered by depth
  // The plane through a visible point determines whether plane indices increase or decrease with depth.
  const Vec3& n = request.planes.normal;
  const double towards_eye =
      request.planes.spacing * (dot(n, {eye_[0], eye_[1], eye_[2]}) - dot(n, seen_point(request)) * eye_[3]);
  reversed_ = towards_eye > 0;
}

}  // namespace understudy::volume
