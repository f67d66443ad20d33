// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/slice_polygons.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adversary {
namespace {

constexpr Vector centre{0.5F, 0.5F, 0.5F};

Vector corner(int number) {
  return {static_cast<float>(number & 1), static_cast<float>(number >> 1 & 1),
          static_cast<float>(number >> 2 & 1)};
}

void sort_around(Vector normal, Polygon& polygon) {
  Vector middle;
  for (const Vector point : polygon) middle = middle + 1 / static_cast<float>(polygon.size()) * point;
  const Vector u = normalized(cross(normal, std::abs(normal.x) < 0.9F ? Vector{1, 0, 0} : Vector{0, 1, 0}));
  const Vector v = cross(normal, u);
  const auto angle = [&](Vector p) { return std::atan2(dot(p - middle, v), dot(p - middle, u)); };
  std::sort(polygon.begin(), polygon.end(), [&](Vector a, Vector b) { return angle(a) < angle(b); });
}

std::vector<Polygon> slices(Vector normal, float farthest, float spacing, int count, Order order) {
  std::vector<Polygon> found;
  for (int i = 0; i < count; ++i) {
    const float steps = 0.5F + static_cast<float>(order == Order::back_to_front ? i : count - 1 - i);
    Polygon polygon = cut_box(normal, farthest - spacing * steps);
    if (polygon.size() >= 3) found.push_back(std::move(polygon));
  }
  return found;
}

}  // namespace

Polygon cut_box(Vector normal, float distance) {
  Polygon polygon;
  for (int from = 0; from < 8; ++from)
    for (const int bit : {1, 2, 4}) {
      if ((from & bit) != 0) continue;
      const Vector a = corner(from), b = corner(from | bit);
      const float before = dot(normal, a) - distance, after = dot(normal, b) - distance;
      if ((before < 0) != (after < 0)) polygon.push_back(a + before / (before - after) * (b - a));
    }
  if (polygon.size() >= 3) sort_around(normal, polygon);
  return polygon;
}

std::vector<Polygon> view_aligned_slices(const Camera& camera, int count, Order order) {
  const float diagonal = std::numbers::sqrt3_v<float>;
  return slices(camera.forward, dot(camera.forward, centre) + diagonal / 2,
                diagonal / static_cast<float>(count), count, order);
}

int axis_nearest_to(Vector direction) {
  const float x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

std::vector<Polygon> axis_aligned_slices(const Camera& camera, int count, Order order) {
  const int axis = axis_nearest_to(camera.forward);
  Vector normal{axis == 0 ? 1.0F : 0, axis == 1 ? 1.0F : 0, axis == 2 ? 1.0F : 0};
  const bool away = dot(normal, camera.forward) > 0;
  if (!away) normal = -1.0F * normal;
  return slices(normal, away ? 1 : 0, 1 / static_cast<float>(count), count, order);
}

std::vector<Vector> triangles(std::span<const Polygon> polygons) {
  std::vector<Vector> corners;
  for (const Polygon& polygon : polygons)
    for (std::size_t i = 2; i < polygon.size(); ++i)
      corners.insert(corners.end(), {polygon[0], polygon[i - 1], polygon[i]});
  return corners;
}

std::vector<Vector> box_triangles() {
  // The four corners of each face, counter-clockwise as seen from outside.
  constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<Polygon> polygons;
  for (const auto& face : faces) {
    Polygon polygon;
    for (const int number : face) polygon.push_back(corner(number));
    polygons.push_back(polygon);
  }
  return triangles(polygons);
}

}  // namespace adversary
