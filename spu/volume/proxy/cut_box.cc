// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/cut_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::Vec3;

constexpr double same_share_of_edge = 1e-4;  // of the box's edge
constexpr double same_share_of_face = 1e-3;  // of its face

/// Twice the polygon's area, along its normal.
Vec3 twice_area(const std::vector<Vec3>& polygon) {
  Vec3 sum{};
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec3 a = volume::subtract(polygon[i - 1], polygon[0]);
    const Vec3 b = volume::subtract(polygon[i], polygon[0]);
    sum = volume::add(sum, volume::cross(a, b));
  }
  return sum;
}

/// The part of a polygon in a half-space.
std::vector<Vec3> part_behind(const std::vector<Vec3>& polygon, const volume::HalfSpace& half) {
  std::vector<Vec3> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double da = volume::dot(half.normal, a) + half.offset;
    const double db = volume::dot(half.normal, b) + half.offset;
    if (da >= 0) part.push_back(a);
    if ((da >= 0) != (db >= 0))
      part.push_back(volume::add(a, volume::scale(volume::subtract(b, a), da / (da - db))));
  }
  return part;
}

std::vector<Vec3> face_of_unit_cube(std::size_t face) {
  std::vector<Vec3> square;
  for (const auto& [a, b] : {std::array{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    Vec3 corner{};
    corner[face / 2] = double(face % 2);
    corner[(face / 2 + 1) % 3] = a;
    corner[(face / 2 + 2) % 3] = b;
    square.push_back(corner);
  }
  return square;
}

/// The face of the unit cube that a polygon lies on.
std::optional<std::size_t> face_under(const std::vector<Vec3>& polygon) {
  for (std::size_t face = 0; face < 6; ++face) {
    const bool on = std::all_of(polygon.begin(), polygon.end(), [&](const Vec3& p) {
      return std::abs(p[face / 2] - double(face % 2)) <= same_share_of_edge;
    });
    if (on) return face;
  }
  return std::nullopt;
}

/// Needs at least one vertex.
volume::Box box_around(const ObservedPolygons& polygons) {
  volume::Box box{polygons.vertices.front().texture, polygons.vertices.front().texture};
  for (const ObservedVertex& v : polygons.vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], v.texture[k]);
      box.high[k] = std::max(box.high[k], v.texture[k]);
    }
  }
  return box;
}

}  // namespace

std::optional<CutBox> cut_box_of(const ObservedPolygons& polygons) {
  if (polygons.count() < 4) return std::nullopt;
  const volume::Box box = box_around(polygons);
  const Vec3 edge = volume::subtract(box.high, box.low);
  if (!(edge[0] > 0 && edge[1] > 0 && edge[2] > 0)) return std::nullopt;

  // In the unit cube: the areas covered on its faces, and the polygons on none of them.
  std::vector<Vec3> all;
  std::vector<Vec3> on_cut;
  std::array<double, 6> covered{};
  Vec3 cut_area{};
  for (std::size_t p = 0; p < polygons.count(); ++p) {
    std::vector<Vec3> polygon;
    for (const ObservedVertex& v : polygons.polygon(p)) {
      Vec3& place = polygon.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) place[k] = (v.texture[k] - box.low[k]) / edge[k];
    }
    all.insert(all.end(), polygon.begin(), polygon.end());
    const Vec3 area = volume::scale(twice_area(polygon), 0.5);
    if (const auto face = face_under(polygon)) {
      covered[*face] += volume::length(area);
      continue;
    }
    on_cut.insert(on_cut.end(), polygon.begin(), polygon.end());
    const double side = volume::dot(area, cut_area) < 0 ? -1 : 1;
    cut_area = volume::add(cut_area, volume::scale(area, side));
  }
  const double area_of_cut = volume::length(cut_area);
  if (on_cut.empty() || !(area_of_cut > 0)) return std::nullopt;

  volume::HalfSpace cut{volume::scale(cut_area, 1 / area_of_cut), 0};
  for (const Vec3& p : on_cut) cut.offset -= volume::dot(cut.normal, p) / double(on_cut.size());
  double side = 0;
  for (const Vec3& p : all) side += volume::dot(cut.normal, p) + cut.offset;
  if (side < 0) cut = {volume::scale(cut.normal, -1), -cut.offset};
  const auto above = [&](const Vec3& p) { return volume::dot(cut.normal, p) + cut.offset; };
  const bool flat =
      std::all_of(on_cut.begin(), on_cut.end(), [&](const Vec3& p) { return above(p) <= same_share_of_edge; });
  const bool convex =
      std::all_of(all.begin(), all.end(), [&](const Vec3& p) { return above(p) >= -same_share_of_edge; });
  if (!flat || !convex) return std::nullopt;

  // The area vectors of a closed surface sum to zero: the cut has the area that the faces lack.
  Vec3 open{};
  for (std::size_t face = 0; face < 6; ++face) {
    const double expected = volume::length(twice_area(part_behind(face_of_unit_cube(face), cut))) / 2;
    if (std::abs(covered[face] - expected) > same_share_of_face) return std::nullopt;
    open[face / 2] += face % 2 == 0 ? expected : -expected;
  }
  if (std::abs(volume::length(open) - area_of_cut) > same_share_of_face) return std::nullopt;
  CutBox found{box, {{}, cut.offset}};
  for (std::size_t k = 0; k < 3; ++k) {
    found.cut.normal[k] = cut.normal[k] / edge[k];
    found.cut.offset -= found.cut.normal[k] * box.low[k];
  }
  return found;
}

}  // namespace understudy::spu
