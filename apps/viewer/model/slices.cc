// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/slices.h"

#include <algorithm>

namespace viewer {

namespace {

// Corner i is at the upper end of axis a if bit a of i is set. Each edge joins two
// corners that differ in one bit.
struct Edge {
  int from, to;
};
constexpr std::array<Edge, 12> box_edges = {
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

Vec3 corner(const Box& box, int index) {
  const Vec3 signs = {index & 1 ? 0.5 : -0.5, index & 2 ? 0.5 : -0.5, index & 4 ? 0.5 : -0.5};
  return scale(signs, box.edges);
}

// Returns two directions that span the plane.
std::array<Vec3, 2> plane_basis(const Vec3& normal) {
  const Vec3 helper = std::abs(normal[2]) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 u = normalised(cross(helper, normal));
  return {u, cross(normal, u)};
}

}  // namespace

Box box_of(const VolumeSize& size, const Vec3& spacing) {
  const Vec3 edges = {static_cast<double>(size[0]) * spacing[0], static_cast<double>(size[1]) * spacing[1],
                      static_cast<double>(size[2]) * spacing[2]};
  const double per_diagonal = 1.0 / length(edges);
  return {per_diagonal * edges, per_diagonal * *std::min_element(spacing.begin(), spacing.end())};
}

int slices_across_diagonal(const Box& box, int requested) {
  if (requested > 0) return requested;
  return static_cast<int>(std::min(std::ceil(1.0 / box.finest_voxel_edge), static_cast<double>(max_slices)));
}

SliceStack cut_slices(const Box& box, const Vec3& direction, int across_diagonal) {
  SliceStack stack;
  stack.normal = direction;
  stack.spacing = 1.0 / across_diagonal;
  const auto [u, v] = plane_basis(direction);

  for (int k = across_diagonal - 1; k >= 0; --k) {
    const double offset = (k + 0.5 - 0.5 * across_diagonal) * stack.spacing;
    std::array<double, 8> distance;
    for (int i = 0; i < 8; ++i) distance[i] = dot(direction, corner(box, i)) - offset;

    std::vector<Vec3> points;
    for (const Edge& edge : box_edges) {
      // Half-open, so that a plane through a corner meets each of its edges consistently.
      if ((distance[edge.from] < 0) == (distance[edge.to] < 0)) continue;
      const double t = distance[edge.from] / (distance[edge.from] - distance[edge.to]);
      const Vec3 a = corner(box, edge.from), b = corner(box, edge.to);
      points.push_back(a + t * (b - a));
    }
    if (points.size() < 3) continue;

    Vec3 centre{};
    for (const Vec3& p : points) centre = centre + (1.0 / static_cast<double>(points.size())) * p;
    const auto angle = [&, u = u, v = v](const Vec3& p) {
      return std::atan2(dot(v, p - centre), dot(u, p - centre));
    };
    std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });

    stack.slices.push_back(
        {offset, static_cast<std::uint32_t>(stack.vertices.size()), static_cast<std::uint32_t>(points.size())});
    for (const Vec3& p : points) {
      const Vec3 texture = {p[0] / box.edges[0] + 0.5, p[1] / box.edges[1] + 0.5, p[2] / box.edges[2] + 0.5};
      stack.vertices.push_back({to_float(texture), to_float(p)});
    }
  }
  return stack;
}

}  // namespace viewer
