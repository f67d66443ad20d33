// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/opaque_geometry.h"

#include <algorithm>

namespace viewer {

namespace {

// The frame is slightly larger than the box, so that its lines and the slices' edges never have the same depth.
constexpr double frame_gap = 0.004;
constexpr Vec3f frame_colour = {0.6F, 0.6F, 0.6F};

constexpr double arrow_length = 0.22;
constexpr double shaft_radius = 0.005;
constexpr double head_length = 0.05;
constexpr double head_radius = 0.014;
constexpr int arrow_sides = 16;

constexpr double ball_radius = 0.12;
constexpr int ball_rings = 24;

void add_frame(const Box& box, OpaqueGeometry& geometry) {
  const Vec3 half = 0.5 * box.edges + Vec3{frame_gap, frame_gap, frame_gap};
  for (int along = 0; along < 3; ++along)
    for (int corner = 0; corner < 4; ++corner) {
      Vec3 from = half;
      from[(along + 1) % 3] *= corner & 1 ? 1 : -1;
      from[(along + 2) % 3] *= corner & 2 ? 1 : -1;
      Vec3 to = from;
      from[along] = -half[along];
      geometry.lines.push_back({to_float(from), frame_colour});
      geometry.lines.push_back({to_float(to), frame_colour});
    }
}

// The light comes from a fixed direction and is included in the colours, so that all
// drawing modes show the same.
void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& colour, OpaqueGeometry& geometry) {
  const Vec3 light = normalised({0.4, -0.7, 0.6});
  const Vec3 normal = normalised(cross(b - a, c - a));
  const Vec3f shaded = to_float((0.35 + 0.65 * std::max(0.0, dot(normal, light))) * colour);
  for (const Vec3& p : {a, b, c}) geometry.triangles.push_back({to_float(p), shaded});
}

void add_arrow(const Vec3& origin, int axis, OpaqueGeometry& geometry) {
  Vec3 along{}, u{}, v{}, colour = {0.15, 0.15, 0.15};
  along[axis] = 1;
  u[(axis + 1) % 3] = 1;
  v[(axis + 2) % 3] = 1;
  colour[axis] = 1;
  const auto ring = [&](double at, double radius, int side) {
    const double angle = 2 * std::numbers::pi * side / arrow_sides;
    return origin + at * along + radius * (std::cos(angle) * u + std::sin(angle) * v);
  };
  const double neck = arrow_length - head_length;
  for (int side = 0; side < arrow_sides; ++side) {
    const Vec3 foot = ring(0, shaft_radius, side), next_foot = ring(0, shaft_radius, side + 1);
    const Vec3 top = ring(neck, shaft_radius, side), next_top = ring(neck, shaft_radius, side + 1);
    const Vec3 brim = ring(neck, head_radius, side), next_brim = ring(neck, head_radius, side + 1);
    add_triangle(foot, next_foot, next_top, colour, geometry);
    add_triangle(foot, next_top, top, colour, geometry);
    add_triangle(brim, next_brim, origin + arrow_length * along, colour, geometry);
    add_triangle(next_brim, brim, origin + neck * along, colour, geometry);
    add_triangle(next_foot, foot, origin, colour, geometry);
  }
}

}  // namespace

OpaqueGeometry frame_and_axes(const Box& box) {
  OpaqueGeometry geometry;
  add_frame(box, geometry);
  for (int axis = 0; axis < 3; ++axis) add_arrow(-0.5 * box.edges, axis, geometry);
  return geometry;
}

void add_ball(const Box& box, OpaqueGeometry& geometry) {
  const Vec3 centre = scale({0.2, -0.3, 0.2}, box.edges);
  const auto at = [&](int ring, int side) {
    const double polar = std::numbers::pi * ring / ball_rings;
    const double around = std::numbers::pi * side / ball_rings;
    return centre + ball_radius * Vec3{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                       std::cos(polar)};
  };
  const Vec3 colour = {0.9, 0.6, 0.1};
  for (int ring = 0; ring < ball_rings; ++ring)
    for (int side = 0; side < 2 * ball_rings; ++side) {
      // At the poles, one of the two triangles is degenerate.
      if (ring + 1 < ball_rings)
        add_triangle(at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), colour, geometry);
      if (ring > 0) add_triangle(at(ring, side), at(ring + 1, side + 1), at(ring, side + 1), colour, geometry);
    }
}

OpaqueGeometry whole_image(const Vec3f& colour) {
  OpaqueGeometry geometry;
  for (const Vec3f& corner : {Vec3f{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}})
    geometry.triangles.push_back({corner, colour});
  return geometry;
}

}  // namespace viewer
