// SPDX-License-Identifier: Apache-2.0
#include "volume/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "volume/cell_lattice.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

using Polygon = std::vector<Vec4>;  // in clip space

/// Sutherland-Hodgman clipping: the part of `polygon` where `distance` is not negative.
template <typename Distance>
Polygon clipped(const Polygon& polygon, Distance distance) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec4 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = distance(a), db = distance(b);
    if (da >= 0) kept.push_back(a);
    if ((da >= 0) != (db >= 0)) {
      const double s = da / (da - db);
      Vec4 crossing{};
      for (int k = 0; k < 4; ++k) crossing[k] = a[k] + s * (b[k] - a[k]);
      kept.push_back(crossing);
    }
  }
  return kept;
}

/// First pixel whose centre may lie to the right of `edge`, and one past the last whose centre may lie to its
/// left; clamped to the window before the conversion to int.
int first_pixel(double edge, int low, int high) {
  return int(std::clamp(std::floor(edge - 0.5), double(low), double(high)));
}
int end_pixel(double edge, int low, int high) {
  return int(std::clamp(std::ceil(edge + 0.5), double(low), double(high)));
}

}  // namespace

Rect footprint(const RenderRequest& request, const Box& box) {
  const Rect window = intersection(request.window, request.viewport);
  if (window.empty()) return {};
  Vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = std::max(box.low[axis], request.region.low[axis]);
    high[axis] = std::min(box.high[axis], request.region.high[axis]);
    if (!(low[axis] <= high[axis])) return {};
  }

  // The near and far planes clip the box to its visible part. They intersect only outside the view frustum, so
  // every corner of that part lies on a face of the box, and the clipped faces contain its whole outline.
  double x_low = std::numeric_limits<double>::infinity(), x_high = -x_low, y_low = x_low, y_high = -x_low;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Polygon face;
      for (const int turn : {0, 1, 2, 3}) {
        Vec3 corner;
        corner[axis] = side ? high[axis] : low[axis];
        corner[u] = turn == 1 || turn == 2 ? high[u] : low[u];
        corner[v] = turn >= 2 ? high[v] : low[v];
        face.push_back(transform_point(request.texture_to_clip, corner));
      }
      face = clipped(face, [](const Vec4& c) { return c[3] + c[2]; });
      face = clipped(face, [](const Vec4& c) { return c[3] - c[2]; });
      for (const Vec4& c : face) {
        const double largest = std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
        if (!(c[3] > 1e-12 * largest)) return window;  // reaches the eye: may cover any pixel
        const double x = c[0] / c[3], y = c[1] / c[3];
        x_low = std::min(x_low, x);
        x_high = std::max(x_high, x);
        y_low = std::min(y_low, y);
        y_high = std::max(y_high, y);
      }
    }
  if (!(x_low <= x_high)) return {};

  const auto window_x = [&](double x) { return request.viewport.x + (x + 1) / 2 * request.viewport.width; };
  const auto window_y = [&](double y) { return request.viewport.y + (y + 1) / 2 * request.viewport.height; };
  const int x0 = first_pixel(window_x(x_low), window.x, window.x + window.width);
  const int x1 = end_pixel(window_x(x_high), window.x, window.x + window.width);
  const int y0 = first_pixel(window_y(y_low), window.y, window.y + window.height);
  const int y1 = end_pixel(window_y(y_high), window.y, window.y + window.height);
  return x1 > x0 && y1 > y0 ? Rect{x0, y0, x1 - x0, y1 - y0} : Rect{};
}

Rect footprint(const RenderRequest& request, const VolumeDescription& volume, const TexelBox& cells) {
  for (int axis = 0; axis < 3; ++axis)
    if (cells.low[axis] >= cells.high[axis]) return {};
  // A ray's first or last sample may lie outside the region, in cells that the ray does not cross.
  if (request.steps && request.steps->any_beyond_end()) return footprint(request, request.region);
  return footprint(request, texture_box(volume, cells));
}

}  // namespace understudy::volume
