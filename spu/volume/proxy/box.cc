// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/box.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volume/matrix.h"

namespace understudy::spu {

using volume::add;
using volume::scale;
using volume::subtract;
using volume::Vec3;
using volume::Vec4;

namespace {

/// Which of the box's faces a camera sees from outside: low and high of each axis.
std::array<bool, 6> seen_faces(const volume::Matrix4& camera, const volume::Box& box) {
  // The eye is the point that maps to a multiple of (0, 0, 1, 0); with w = 0 it is a direction of view.
  const volume::Matrix4 back = volume::inverse(camera).value_or(volume::identity());
  const Vec4 eye = volume::transform(back, {0, 0, -1, 0});
  const double rounding = 1e-9 * (std::abs(eye[0]) + std::abs(eye[1]) + std::abs(eye[2]));
  const double side = eye[3] < -rounding ? -1 : 1;
  std::array<bool, 6> seen{};
  for (std::size_t k = 0; k < 3; ++k) {
    seen[2 * k] = side * eye[k] < side * eye[3] * box.low[k];
    seen[2 * k + 1] = side * eye[k] > side * eye[3] * box.high[k];
  }
  return seen;
}

}  // namespace

std::optional<volume::Box> box_of(const ObservedPolygons& polygons, const volume::Matrix4& camera) {
  constexpr double same_place = 1e-4;  // of the box's edge
  if (polygons.count() < 2) return std::nullopt;
  volume::Box box{polygons.vertices.front().texture, polygons.vertices.front().texture};
  for (const ObservedVertex& v : polygons.vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], v.texture[k]);
      box.high[k] = std::max(box.high[k], v.texture[k]);
    }
  }
  const Vec3 edge = subtract(box.high, box.low);
  if (!(edge[0] > 0 && edge[1] > 0 && edge[2] > 0)) return std::nullopt;

  std::array<double, 6> covered{};  // of each face, as a fraction of its area
  for (std::size_t p = 0; p < polygons.count(); ++p) {
    const auto corners = polygons.polygon(p);
    std::optional<std::size_t> face;
    for (std::size_t k = 0; k < 3; ++k) {
      for (const bool high : {false, true}) {
        const double side = high ? box.high[k] : box.low[k];
        const bool lies_on = std::all_of(corners.begin(), corners.end(), [&](const ObservedVertex& v) {
          return std::abs(v.texture[k] - side) <= same_place * edge[k];
        });
        if (lies_on) face = 2 * k + (high ? 1 : 0);
      }
    }
    if (!face) return std::nullopt;
    const std::size_t k = *face / 2;
    const std::size_t u = (k + 1) % 3;
    const std::size_t v = (k + 2) % 3;
    double twice_area = 0;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const Vec3 a = subtract(corners[i - 1].texture, corners[0].texture);
      const Vec3 b = subtract(corners[i].texture, corners[0].texture);
      twice_area += std::abs(a[u] * b[v] - a[v] * b[u]);
    }
    covered[*face] += twice_area / (2 * edge[u] * edge[v]);
  }
  std::array<bool, 6> drawn{};
  for (std::size_t i = 0; i < covered.size(); ++i) {
    drawn[i] = covered[i] > 0;
    if (drawn[i] && !(std::abs(covered[i] - 1) <= 1e-3)) return std::nullopt;
  }
  const bool all = std::count(drawn.begin(), drawn.end(), true) == 6;
  if (!all && drawn != seen_faces(camera, box)) return std::nullopt;
  return box;
}

bool wholly_in_view(const volume::Matrix4& texture_to_clip, const volume::Box& box) {
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = (corner >> k & 1) != 0 ? box.high[k] : box.low[k];
    const Vec4 clip = volume::transform_point(texture_to_clip, t);
    if (!(clip[3] > 0 && clip[2] > -clip[3])) return false;
  }
  return true;
}

bool wholly_in_view(const ObservedPolygons& polygons) {
  return std::all_of(polygons.vertices.begin(), polygons.vertices.end(),
                     [](const ObservedVertex& v) { return v.clip[3] > 0 && v.clip[2] > -v.clip[3]; });
}

RaysThroughBox::RaysThroughBox(const volume::Matrix4& texture_to_clip, const volume::Box& box,
                               const std::vector<volume::HalfSpace>& cuts)
    : clip_to_texture_(volume::inverse(texture_to_clip).value_or(volume::identity())), box_(box), cuts_(cuts) {
  if (!cuts_.empty()) {
    // The box's middle may lie outside the view, or behind the eye: take the longest ray instead.
    constexpr int places = 8;  // to each side
    double longest = 0;
    for (int y = -places; y <= places; ++y) {
      for (int x = -places; x <= places; ++x) {
        const std::array<double, 2> place{0.9 * x / places, 0.9 * y / places};
        const auto through = way(place[0], place[1]);
        if (!through || volume::length(*through) <= longest) continue;
        longest = volume::length(*through);
        middle_ = place;
      }
    }
    return;
  }
  const Vec3 centre = scale(add(box.low, box.high), 0.5);
  const Vec4 clip = volume::transform_point(texture_to_clip, centre);
  middle_ = {clip[0] / clip[3], clip[1] / clip[3]};
}

std::optional<Vec3> RaysThroughBox::way(double x, double y) const {
  const auto stretch = through(x, y);
  if (!stretch) return std::nullopt;
  return stretch->way;
}

std::optional<WayThroughBox> RaysThroughBox::through(double x, double y) const {
  std::array<Vec3, 2> ends;
  for (const bool far : {false, true}) {
    const Vec4 p = volume::transform(clip_to_texture_, {x, y, far ? 1.0 : -1.0, 1});
    ends[far ? 1 : 0] = {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
  }
  const Vec3 along = subtract(ends[1], ends[0]);
  double enter = -std::numeric_limits<double>::infinity();
  double leave = -enter;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = box_.low[k] - ends[0][k];
    const double high = box_.high[k] - ends[0][k];
    if (along[k] == 0) {
      if (low > 0 || high < 0) return std::nullopt;
      continue;
    }
    enter = std::max(enter, std::min(low / along[k], high / along[k]));
    leave = std::min(leave, std::max(low / along[k], high / along[k]));
  }
  for (const volume::HalfSpace& cut : cuts_) {
    const double value = volume::dot(cut.normal, ends[0]) + cut.offset;
    const double slope = volume::dot(cut.normal, along);
    if (slope > 0) enter = std::max(enter, -value / slope);
    if (slope < 0) leave = std::min(leave, -value / slope);
    if (slope == 0 && value < 0) return std::nullopt;
  }
  if (!(enter < leave)) return std::nullopt;
  return WayThroughBox{add(ends[0], scale(along, enter)), scale(along, leave - enter)};
}

}  // namespace understudy::spu
