// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/slices.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::cross;
using volume::dot;
using volume::HalfSpace;
using volume::length;
using volume::subtract;
using volume::Vec3;

/// Offsets of the vertices of one slice, and of neighbouring slices in the application's own arithmetic, agree
/// to the float precision of texture coordinates; the spacing in real viewers is above 1e-4.
constexpr double same_plane = 2e-6;
/// Slices are evenly spaced if no offset deviates by more than this fraction of the spacing.
constexpr double even_spacing = 0.02;
/// A coordinate this close to the texture's edge is the edge.
constexpr double snap = 1e-4;
/// Slices lie across an axis if their normal has at least this component along it.
constexpr double across_axis = 0.999;
/// Tolerated relative difference between observed and expected area.
constexpr double same_area = 5e-3;

/// Twice the area vector of a planar polygon.
template <class Points>
Vec3 area_vector(const Points& points) {
  Vec3 sum{};
  for (std::size_t i = 2; i < points.size(); ++i) {
    const Vec3 c = cross(subtract(points[i - 1], points[0]), subtract(points[i], points[0]));
    for (int k = 0; k < 3; ++k) sum[k] += c[k];
  }
  return sum;
}

std::vector<Vec3> clipped(std::vector<Vec3> polygon, const HalfSpace& keep) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double da = dot(keep.normal, a) + keep.offset;
    const double db = dot(keep.normal, b) + keep.offset;
    if (da >= 0) result.push_back(a);
    if ((da >= 0) != (db >= 0)) {
      const double s = da / (da - db);
      result.push_back({a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])});
    }
  }
  return result;
}

/// A square on the plane, large enough to cover everything near the unit cube.
std::vector<Vec3> plane_square(const Vec3& normal, double offset) {
  const int axis = std::abs(normal[0]) < 0.6 ? 0 : std::abs(normal[1]) < 0.6 ? 1 : 2;
  Vec3 helper{};
  helper[axis] = 1;
  Vec3 u = cross(normal, helper);
  const double lu = length(u);
  for (double& x : u) x /= lu;
  const Vec3 v = cross(normal, u);
  constexpr double reach = 8;
  std::vector<Vec3> square;
  for (const auto& [a, b] : {std::pair{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}}) {
    Vec3 p{};
    for (int k = 0; k < 3; ++k) p[k] = normal[k] * offset + a * u[k] + b * v[k];
    square.push_back(p);
  }
  return square;
}

/// The six half-spaces of the view volume, -w <= x, y, z <= w, transformed to texture space.
std::vector<HalfSpace> view_volume(const volume::Matrix4& a) {
  std::vector<HalfSpace> planes;
  for (int row = 0; row < 3; ++row) {
    for (double sign : {1.0, -1.0}) {
      HalfSpace h;
      for (int k = 0; k < 3; ++k) h.normal[k] = a[12 + k] + sign * a[4 * row + k];
      h.offset = a[15] + sign * a[4 * row + 3];
      planes.push_back(h);
    }
  }
  return planes;
}

double depth_at(const volume::Matrix4& a, const Vec3& t) {
  const double z = a[8] * t[0] + a[9] * t[1] + a[10] * t[2] + a[11];
  const double w = a[12] * t[0] + a[13] * t[1] + a[14] * t[2] + a[15];
  return z / w;
}

/// The normal of all slices: the sum of all area vectors, equally oriented, so that slivers count little.
struct CommonNormal {
  Vec3 normal{};
  double total = 0;          ///< length of the sum
  double observed_area = 0;  ///< of all polygons, doubled
};

CommonNormal common_normal(const ObservedPolygons& polygons) {
  CommonNormal common;
  std::vector<Vec3> points;
  for (std::size_t p = 0; p < polygons.count(); ++p) {
    points.clear();
    for (const ObservedVertex& v : polygons.polygon(p)) points.push_back(v.texture);
    const Vec3 area = area_vector(points);
    const double sign = dot(area, common.normal) < 0 ? -1 : 1;
    for (int k = 0; k < 3; ++k) common.normal[k] += sign * area[k];
    common.observed_area += length(area);
  }
  common.total = length(common.normal);
  if (common.total > 0) {
    for (double& x : common.normal) x /= common.total;
  }
  return common;
}

/// Offsets of the slices along their normal, in drawing order, and the box around the slices.
struct Places {
  std::vector<double> offsets;
  volume::Box box{{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
};

/// Null if a slice is not flat.
std::optional<Places> places_of(const ObservedPolygons& polygons, const Vec3& normal) {
  Places places;
  std::vector<Vec3> points;
  for (std::size_t p = 0; p < polygons.count(); ++p) {
    double low = 1e30;
    double high = -1e30;
    points.clear();
    for (const ObservedVertex& v : polygons.polygon(p)) {
      points.push_back(v.texture);
      const double d = dot(normal, v.texture);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    // Degenerate polygons (batched tiles) draw nothing and are ignored.
    if (length(area_vector(points)) < 1e-12) continue;
    if (high - low > 16 * same_plane) return std::nullopt;
    for (const Vec3& t : points) {
      for (int k = 0; k < 3; ++k) {
        places.box.low[k] = std::min(places.box.low[k], t[k]);
        places.box.high[k] = std::max(places.box.high[k], t[k]);
      }
    }
    const double offset = (low + high) / 2;
    if (places.offsets.empty() || std::abs(offset - places.offsets.back()) > 16 * same_plane)
      places.offsets.push_back(offset);
  }
  return places;
}

/// Moves coordinates close to the texture's edge to the edge. Returns false if the box leaves the texture.
bool snap_to_texture(volume::Box& box) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(box.low[k]) < snap) box.low[k] = 0;
    if (std::abs(box.high[k] - 1) < snap) box.high[k] = 1;
    if (box.low[k] < 0 || box.high[k] > 1) return false;
  }
  return true;
}

/// Returns the distance from one slice to the next; null if slices are not equally spaced.
std::optional<double> step_between(const std::vector<double>& offsets) {
  const std::size_t n = offsets.size();
  const double step = (offsets.back() - offsets.front()) / double(n - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (std::abs(offsets.front() + double(i) * step - offsets[i]) > even_spacing * std::abs(step))
      return std::nullopt;
  }
  return step;
}

/// Returns whether plane 0 is the nearest to the eye.
bool starts_at_eye(const volume::SlicePlanes& planes, const volume::Box& box, const volume::Matrix4& camera) {
  const Vec3 middle{(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2,
                    (box.low[2] + box.high[2]) / 2};
  Vec3 beyond = middle;
  for (int k = 0; k < 3; ++k) beyond[k] += 1e-3 * (planes.spacing < 0 ? -planes.normal[k] : planes.normal[k]);
  return !(depth_at(camera, beyond) < depth_at(camera, middle));
}

/// Returns the area, doubled, of the intersection of the planes with the box, the clip planes and, if polygons
/// were clipped, the view volume.
double expected_area(const Vec3& normal, const Places& places, std::span<const HalfSpace> clip_planes,
                     bool clipped_to_view, const volume::Matrix4& camera) {
  std::vector<HalfSpace> cuts(clip_planes.begin(), clip_planes.end());
  for (int k = 0; k < 3; ++k) {
    HalfSpace low;
    low.normal[k] = 1;
    low.offset = -places.box.low[k];
    HalfSpace high;
    high.normal[k] = -1;
    high.offset = places.box.high[k];
    cuts.push_back(low);
    cuts.push_back(high);
  }
  if (clipped_to_view) {
    const auto view = view_volume(camera);
    cuts.insert(cuts.end(), view.begin(), view.end());
  }
  double area = 0;
  for (const double offset : places.offsets) {
    std::vector<Vec3> polygon = plane_square(normal, offset);
    for (const HalfSpace& cut : cuts) polygon = clipped(std::move(polygon), cut);
    area += length(area_vector(polygon));
  }
  return area;
}

}  // namespace

SliceFinding find_slices(const ObservedPolygons& polygons, const CameraFit& camera,
                         std::span<const volume::HalfSpace> clip_planes, SliceOrder order) {
  const CommonNormal common = common_normal(polygons);
  const Vec3& normal = common.normal;
  if (!(common.total > 0)) return "slices have no area";
  if (common.total < 0.999 * common.observed_area) return "slices are not parallel";
  auto places = places_of(polygons, normal);
  if (!places) return "slices are not flat in texture space";
  const std::vector<double>& offsets = places->offsets;
  if (offsets.size() < 2) return "fewer than two slices";
  if (!snap_to_texture(places->box)) return "slices leave the texture";
  const auto step = step_between(offsets);
  if (!step) return "slices are not equally spaced";

  SliceSet set;
  set.region = places->box;
  set.planes.normal = normal;
  set.planes.first = offsets.back();
  set.planes.spacing = -*step;
  set.planes.count = int(offsets.size());
  if (!starts_at_eye(set.planes, places->box, camera.texture_to_clip)) {
    if (order == SliceOrder::back_to_front) return "slices are drawn front to back under a back-to-front blend";
    set.planes.first = offsets.front();
    set.planes.spacing = *step;
  } else if (order == SliceOrder::front_to_back) {
    return "slices are drawn back to front under a front-to-back blend";
  }
  const double expected = expected_area(normal, *places, clip_planes, polygons.clipped, camera.texture_to_clip);
  if (std::abs(expected - common.observed_area) > same_area * expected) return "slices do not fill a box";
  // Slices across an axis begin and end on the faces of the box: rounding must not lose the outermost two.
  for (int k = 0; k < 3; ++k) {
    if (std::abs(normal[k]) < across_axis) continue;
    set.region.low[k] -= same_plane / 2;
    set.region.high[k] += same_plane / 2;
  }
  return set;
}

}  // namespace understudy::spu
