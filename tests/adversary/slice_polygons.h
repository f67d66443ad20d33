// SPDX-License-Identifier: Apache-2.0
// Where planes cut the box [0,1]^3.
#pragma once

#include <span>
#include <vector>

#include "tests/adversary/matrix.h"

namespace adversary {

using Polygon = std::vector<Vector>;  ///< convex, its corners in order

/// Where dot(normal, p) == distance. Fewer than three corners: the plane misses the box.
Polygon cut_box(Vector normal, float distance);

enum class Order { back_to_front, front_to_back };

/// `count` planes across the view, at equal distances that do not depend on the view. Only those that meet the
/// box.
std::vector<Polygon> view_aligned_slices(const Camera& camera, int count, Order order = Order::back_to_front);
/// `count` planes across the axis that is nearest to the view.
std::vector<Polygon> axis_aligned_slices(const Camera& camera, int count, Order order = Order::back_to_front);
/// 0, 1 or 2.
int axis_nearest_to(Vector direction);

std::vector<Vector> triangles(std::span<const Polygon> polygons);
/// The box's faces, seen from outside counter-clockwise.
std::vector<Vector> box_triangles();

}  // namespace adversary
