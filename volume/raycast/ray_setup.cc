// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/ray_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/raycast/ray_setup.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::volume {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Products and sums are not fused here: every node must round alike, whatever its instruction set.

constexpr std::size_t region_bounds = 6;

/// Sets up one row of rays, before samples outside the owned cells are dropped. `depth` has one value per
/// pixel, or is null. With steps, `begins` has the position of the first sample of every pixel, in steps.
void set_up_row(const RaySetup& setup, const double* depth, const double* begins, bool depth_or_equal,
                std::array<double, 2> depth_range, int x, int y, int width, std::size_t at_row,
                RayPacket& packet) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> d_float;
  const hn::Rebind<std::int32_t, decltype(d)> d_int;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);

  const double ndc_y = setup.first_y + y * setup.pixel_to_y;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
  for (std::size_t column = 0; column < tile_width; column += lanes) {
    const V pixel = hn::Add(hn::Iota(d, double(column)), hn::Set(d, double(x)));
    const V X = hn::Add(hn::Set(d, setup.first_x), hn::Mul(pixel, hn::Set(d, setup.pixel_to_x)));
    const auto evaluate = [&](const LinearInPixel& l) HWY_ATTR {
      return hn::Add(hn::Set(d, l.c + ndc_y * l.y), hn::Mul(X, hn::Set(d, l.x)));
    };
    const V det = evaluate(setup.det), sign = hn::CopySign(one, det);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    V low = hn::Set(d, setup.steps ? -infinity : 0.0);
    V high = hn::Set(d, setup.steps ? infinity : double(setup.last_plane));
    V entry = zero, exit = zero, hidden_from = hn::Set(d, infinity);
    auto meets = hn::And(hn::Gt(hn::Abs(det), hn::Set(d, setup.smallest_det)),
                         hn::Lt(hn::Iota(d, double(column)), hn::Set(d, double(width))));

    // Keeps the indices i with value + i slope >= 0, after multiplying both by the sign of det.
    const auto limit = [&](V value, V slope, bool strict) HWY_ATTR {
      value = hn::Mul(sign, value);
      slope = hn::Mul(sign, slope);
      const auto rising = hn::Gt(slope, zero), falling = hn::Lt(slope, zero);
      const V crossing = hn::Div(hn::Neg(value), slope);
      const V from = strict ? hn::Add(hn::Floor(crossing), one) : crossing;
      const V to = strict ? hn::Sub(hn::Ceil(crossing), one) : crossing;
      low = hn::IfThenElse(rising, hn::Max(low, from), low);
      high = hn::IfThenElse(falling, hn::Min(high, to), high);
      const auto holds = strict ? hn::Gt(value, zero) : hn::Ge(value, zero);
      meets = hn::And(meets, hn::Or(holds, hn::Or(rising, falling)));
    };
    for (std::size_t i = 0; i < setup.bounds.size(); ++i) {
      limit(evaluate(setup.bounds[i].value), evaluate(setup.bounds[i].slope), false);
      if (i + 1 == region_bounds) {
        entry = low;
        exit = high;
      }
    }
    if (depth) {
      const V before = high;
      if (setup.steps) high = hidden_from;
      // Window depth z / w * half + middle < D, times w > 0.
      const V half = hn::Set(d, (depth_range[1] - depth_range[0]) / 2);
      const V room = hn::Sub(hn::LoadU(d, depth + column), hn::Set(d, (depth_range[1] + depth_range[0]) / 2));
      limit(hn::Sub(hn::Mul(evaluate(setup.clip_w.value), room), hn::Mul(evaluate(setup.clip_z.value), half)),
            hn::Sub(hn::Mul(evaluate(setup.clip_w.slope), room), hn::Mul(evaluate(setup.clip_z.slope), half)),
            !depth_or_equal && !setup.steps);
      if (setup.steps) {
        hidden_from = high;
        high = before;
      }
    }
    V part = one;  // index distance between two samples
    V first = hn::Ceil(low), last = hn::Floor(high);
    V begin = first, end = last;  // of segments
    if (setup.steps) {
      V speed = zero;
      for (const LinearInPixel& component : setup.speed) {
        const V along = evaluate(component);
        speed = hn::Add(speed, hn::Mul(along, along));
      }
      part = hn::Div(hn::Abs(det), hn::Sqrt(speed));
      V offset = hn::LoadU(d, begins + column);
      V parts = hn::Set(d, infinity);
      if (setup.steps->divided) {
        const V way = hn::Sub(exit, entry);
        parts = hn::Floor(hn::Add(hn::Div(way, part), hn::Set(d, setup.steps->rounding)));
        if (setup.steps->at_least_one) parts = hn::IfThenElse(hn::Le(entry, exit), hn::Max(parts, one), parts);
        meets = hn::And(meets, hn::Ge(parts, one));
        part = hn::Div(way, parts);
      }
      V whole = zero;  // length of the ray, in steps
      if (setup.steps->cover_whole_ray) {
        entry = low;
        high = hn::Min(high, hidden_from);
        whole = hn::Div(hn::Sub(high, low), part);
        meets = hn::And(meets, hn::Gt(whole, zero));
        offset = hn::Min(offset, hn::Mul(hn::Set(d, 0.5), whole));
      }
      const auto steps_to = [&](V end) HWY_ATTR { return hn::Sub(hn::Div(hn::Sub(end, entry), part), offset); };
      first = hn::Max(hn::Ceil(steps_to(low)), zero);
      const V counted_from = setup.steps->counted_from ? hn::Set(d, *setup.steps->counted_from) : offset;
      const V to_end = hn::Sub(hn::Div(hn::Sub(high, entry), part), counted_from);
      last = hn::Floor(hn::Min(to_end, hn::Sub(parts, one)));
      if (setup.steps->cover_whole_ray) {
        const V left = hn::IfThenElseZero(meets, hn::Sub(whole, last));
        hn::Store(hn::DemoteTo(d_float, left), d_float, packet.last_length.data() + at_row + column);
      }
      begin = setup.segments ? hn::Max(steps_to(low), hn::Neg(one)) : first;
      end = setup.segments ? steps_to(high) : last;
      if (depth) {
        meets = hn::And(meets, hn::Ge(hidden_from, entry));
        const V to_depth = hn::Add(steps_to(hidden_from), hn::Set(d, setup.steps->past_depth));
        last = hn::Min(last, hn::Floor(to_depth));
        end = hn::Min(end, to_depth);
      }
      if (setup.steps->at_least_one) {
        const auto entered = hn::And(hn::Le(entry, exit), hn::Le(entry, high));
        last = hn::IfThenElse(entered, hn::Max(last, zero), last);
        end = hn::Max(end, last);
      }
      low = hn::Add(entry, hn::Mul(hn::Add(offset, first), part));
    } else {
      low = first;
    }
    // Even if no sample lies between begin and end, a piece of a segment may.
    meets =
        hn::And(meets, setup.segments ? hn::Or(hn::Le(first, last), hn::Lt(begin, end)) : hn::Le(first, last));

    const V inverse = hn::Div(one, det);
    low = hn::IfThenElseZero(meets, low);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const V slope = evaluate(setup.position[axis].slope);
      const V at_first = hn::Mul(hn::Add(evaluate(setup.position[axis].value), hn::Mul(low, slope)), inverse);
      const V rest = hn::Set(d, setup.resting_place[axis]);
      const V step = hn::IfThenElseZero(meets, hn::Mul(hn::Mul(slope, inverse), part));
      hn::Store(hn::DemoteTo(d_float, hn::IfThenElse(meets, at_first, rest)), d_float,
                packet.start[axis].data() + at_row + column);
      hn::Store(hn::DemoteTo(d_float, step), d_float, packet.step[axis].data() + at_row + column);
    }
    const V more = hn::IfThenElse(meets, hn::Sub(last, first), hn::Set(d, -1.0));
    V lowest = zero;
    if (setup.ends) {
      const V before = hn::IfThenElseZero(meets, hn::Sub(begin, first));
      const V behind = hn::IfThenElseZero(meets, hn::Sub(end, first));
      lowest = hn::IfThenElseZero(hn::Lt(before, zero), hn::Neg(one));
      hn::Store(hn::DemoteTo(d_float, before), d_float, packet.begin.data() + at_row + column);
      hn::Store(hn::DemoteTo(d_float, behind), d_float, packet.end.data() + at_row + column);
    }
    hn::Store(hn::DemoteTo(d_int, lowest), d_int, packet.first.data() + at_row + column);
    hn::Store(hn::DemoteTo(d_int, more), d_int, packet.last.data() + at_row + column);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace understudy::volume
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "volume/matrix.h"
#include "volume/raycast/segment_scene.h"
#include "volume/request.h"

namespace understudy::volume {

HWY_EXPORT(set_up_row);

namespace {

/// A vector that is linear in the pixel coordinates.
struct LinearVector {
  Vec3 c, x, y;
};

LinearInPixel project(const Vec3& normal, const LinearVector& v) {
  return {dot(normal, v.c), dot(normal, v.x), dot(normal, v.y)};
}

LinearInPixel sum(const LinearInPixel& a, const LinearInPixel& b) {
  return {a.c + b.c, a.x + b.x, a.y + b.y};
}
LinearInPixel times(double factor, const LinearInPixel& a) {
  return {factor * a.c, factor * a.x, factor * a.y};
}

/// Planes that intersect all rays through the viewport, one unit of the index apart, with increasing depth.
/// Plane 0 passes through the centre of the region.
SlicePlanes planes_across(const RenderRequest& request, const LinearVector& direction, const Vec3& across_eye) {
  const auto direction_at = [&](double x, double y) {
    return add(direction.c, add(scale(direction.x, x), scale(direction.y, y)));
  };
  // Planes that face the eye are never parallel to a ray. If the eye is (nearly) at infinity, they are only
  // rounding noise, and the view direction is used instead.
  SlicePlanes planes;
  double best = -1;
  for (const Vec3& normal : {across_eye, direction_at(0, 0)}) {
    if (!(length(normal) > 0)) continue;
    double least = std::numeric_limits<double>::infinity();
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) {
        const Vec3 ray = direction_at(x, y);
        const double cosine = dot(normal, ray) / (length(normal) * length(ray));
        least = std::min(least, dot(normal, direction_at(0, 0)) < 0 ? -cosine : cosine);
      }
    if (!(least > best)) continue;
    best = least;
    planes.normal = scale(normal, 1 / length(normal));
  }
  const Matrix4& m = request.texture_to_clip;
  const Vec3 middle = scale(add(request.region.low, request.region.high), 0.5);
  const Vec4 clip = transform_point(m, middle);
  // The sign of d(z / w) along the normal, at the centre of the image.
  const Vec3 ray = direction_at(0, 0);
  const double z = m[8] * ray[0] + m[9] * ray[1] + m[10] * ray[2];
  const double w = m[12] * ray[0] + m[13] * ray[1] + m[14] * ray[2];
  const bool deeper = (z * clip[3] - w * clip[2] > 0) == (dot(planes.normal, ray) > 0);
  if (!deeper) planes.normal = scale(planes.normal, -1);
  planes.first = dot(planes.normal, middle);
  planes.spacing = 1;
  return planes;
}

/// Smallest k in [least, count] from which on `reached` holds (count: never), for a monotone condition: once
/// true, it stays true.
template <typename Reached>
int first_reached(int least, int count, double guess, Reached reached) {
  const auto at = [&](int k) { return k >= count || (k >= least && reached(k)); };
  const int near = guess > least ? int(std::min(guess, double(count))) : least;  // NaN becomes the least
  for (const int k : {near, near + 1, near - 1})
    if (k <= count && at(k) && !at(k - 1)) return k;
  int low = least, high = count;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (reached(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

/// Clips ray `r` to where it enters and leaves the owned cells.
void cut_to_owned(const RaySetup& setup, RayPacket& packet, std::size_t r) {
  float begin = packet.begin[r], end = packet.end[r];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float start = packet.start[axis][r], step = packet.step[axis][r];
    const auto keep = [&](float bound, bool above) {
      if (step == 0) {
        if ((start >= bound) != above) end = begin - 1;
      } else if ((step > 0) == above) {
        begin = std::max(begin, (bound - start) / step);
      } else {
        end = std::min(end, (bound - start) / step);
      }
    };
    if (setup.low_is_bound[axis]) keep(setup.owned_low[axis], true);
    if (setup.high_is_bound[axis]) keep(setup.owned_high[axis], false);
  }
  if (packet.first[r] > packet.last[r] || !(begin < end)) {
    packet.last[r] = packet.first[r] - 1;
    return;
  }
  packet.begin[r] = begin;
  packet.end[r] = end;
  packet.first[r] = int(std::floor(begin));
  packet.last[r] = int(std::ceil(end)) - 1;
}

/// Narrows the samples of ray `r` to those in the owned cells. Positions are monotone in k on every axis, even
/// in float arithmetic, so these form one interval. It is found with the same arithmetic that computes
/// positions.
void keep_owned(const RaySetup& setup, RayPacket& packet, std::size_t r) {
  if (setup.cut) cut_to_owned(setup, packet, r);
  int first = packet.first[r], last = packet.last[r];
  const int least = first;
  const float begin = setup.ends ? packet.begin[r] : 0.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float start = packet.start[axis][r], step = packet.step[axis][r];
    const auto narrow = [&](float bound, bool keep_above) {
      if (first > last) return;
      if (step == 0) {
        if ((start >= bound) != keep_above) last = first - 1;
        return;
      }
      const auto above = [&](int k) { return std::max(float(k), begin) * step + start >= bound; };
      const bool rising = step > 0;
      const int crossing =
          first_reached(least, last + 1, std::ceil((double(bound) - double(start)) / double(step)),
                        [&](int k) { return above(k) == rising; });
      if (rising == keep_above)
        first = std::max(first, crossing);
      else
        last = std::min(last, crossing - 1);
    };
    if (setup.cut) continue;
    if (setup.low_is_bound[axis]) narrow(setup.owned_low[axis], true);
    if (setup.high_is_bound[axis]) narrow(setup.owned_high[axis], false);
  }
  // The last sample of the ray belongs to another rank.
  if (setup.steps && setup.steps->cover_whole_ray && last < packet.last[r]) packet.last_length[r] = 1;
  packet.first[r] = first;
  packet.last[r] = last;
  if (first > last)  // samples of other ranks may lie in blocks that are not held
    for (std::size_t axis = 0; axis < 3; ++axis) {
      packet.start[axis][r] = setup.resting_place[axis];
      packet.step[axis][r] = 0;
    }
}

}  // namespace

RaySetup::RaySetup(const RenderRequest& request, const BrickStore& store, const TexelBox& owned) {
  const Matrix4& m = request.texture_to_clip;
  const auto row = [&](int r) { return Vec3{m[4 * r], m[4 * r + 1], m[4 * r + 2]}; };
  const Vec3 a0 = row(0), a1 = row(1), a3 = row(3);
  const double w0 = m[3], w1 = m[7], w3 = m[15];

  // The ray's direction, and its intersection with the plane through the origin, both times det.
  const LinearVector direction{cross(a0, a1), cross(a1, a3), cross(a3, a0)};
  const SlicePlanes planes = request.steps ? planes_across(request, direction, a3) : request.planes;
  const Vec3& n = planes.normal;
  const LinearVector origin{cross(n, subtract(scale(a1, w0), scale(a0, w1))),
                            cross(n, subtract(scale(a3, w1), scale(a1, w3))),
                            cross(n, subtract(scale(a0, w3), scale(a3, w0)))};
  det = project(n, direction);
  constexpr double parallel = 1e-12;
  smallest_det =
      parallel * length(n) * std::max({length(direction.c), length(direction.x), length(direction.y)});

  /// normal . t + offset at sample i, times det.
  const auto at_sample = [&](const Vec3& normal, double offset) {
    const LinearInPixel along = project(normal, direction);
    return IndexBound{sum(sum(project(normal, origin), times(planes.first, along)), times(offset, det)),
                      times(planes.spacing, along)};
  };
  const auto negated = [](const IndexBound& b) { return IndexBound{times(-1, b.value), times(-1, b.slope)}; };

  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit{};
    unit[axis] = 1;
    bounds.push_back(at_sample(unit, -request.region.low[axis]));
    bounds.push_back(negated(at_sample(unit, -request.region.high[axis])));

    Vec3 texels{};
    texels[axis] = store.description().size[axis];
    position[axis] = at_sample(texels, -0.5 - store.lattice().origin[axis]);
  }
  clip_z = at_sample(row(2), m[11]);
  clip_w = at_sample(a3, w3);
  const auto plus = [](const IndexBound& a, const IndexBound& b) {
    return IndexBound{sum(a.value, b.value), sum(a.slope, b.slope)};
  };
  bounds.push_back(plus(clip_w, clip_z));           // near plane
  bounds.push_back(plus(clip_w, negated(clip_z)));  // far plane; both together imply w >= 0
  for (const HalfSpace& plane : request.clip_planes) bounds.push_back(at_sample(plane.normal, plane.offset));

  last_plane = planes.count - 1;
  set_viewport(request.viewport);
  set_cells(request, store, owned);
  ends = walks_segments(request);
  cut = request.cut_at_bricks != 0 && request.method == Method::pre_integrated;
  segments = ends && (request.method != Method::post_classified || !request.surfaces.empty());
  steps = request.steps;
  if (steps) {
    const auto& metric = steps->metric;
    for (std::size_t row = 0; row < 3; ++row)
      speed[row] = project({metric[3 * row], metric[3 * row + 1], metric[3 * row + 2]}, direction);
  }
}

void RaySetup::set_viewport(const Rect& viewport) {
  pixel_to_x = 2.0 / viewport.width;
  first_x = (0.5 - viewport.x) * pixel_to_x - 1;
  pixel_to_y = 2.0 / viewport.height;
  first_y = (0.5 - viewport.y) * pixel_to_y - 1;
}

void RaySetup::spread(int pixels) {
  pixels_apart = pixels;
  first_x += pixel_of(0) * pixel_to_x;
  pixel_to_x *= pixels;
  first_y += pixel_of(0) * pixel_to_y;
  pixel_to_y *= pixels;
}

void RaySetup::set_cells(const RenderRequest& request, const BrickStore& store, const TexelBox& owned) {
  const CellLattice& lattice = store.lattice();
  for (int axis = 0; axis < 3; ++axis) {
    const int low = owned.low[axis] - lattice.origin[axis], high = owned.high[axis] - lattice.origin[axis];
    owned_low[axis] = float(low);
    owned_high[axis] = float(high);
    low_is_bound[axis] = low > 0;
    high_is_bound[axis] = high < lattice.cells[axis];
    resting_place[axis] = float(low) + 0.5F;
    const TexelBox& stored = store.description().stored;
    const bool one_texel = lattice.origin[axis] >= 0 && stored.high[axis] - stored.low[axis] == 1;
    top[axis] = one_texel ? 0.0F : std::nextafter(float(lattice.cells[axis]), 0.0F);
    const double reach = std::max(std::abs(request.region.low[axis]), std::abs(request.region.high[axis]));
    rounding[axis] = float(4e-7 * (store.description().size[axis] * (reach + 1) + lattice.cells[axis]));
  }
}

bool set_up_packet(const RaySetup& setup, const RenderRequest& request, int x, int y, int width, int height,
                   RayPacket& packet) {
  constexpr double beyond_every_depth = 2;
  std::array<double, tile_width> depth, begins;
  begins.fill(setup.steps ? setup.steps->first : 0.0);
  for (int row = 0; row < packet_height; ++row) {
    const bool inside = row < height;
    if (inside && request.depth) {
      const DepthImage& image = *request.depth;
      const int v = setup.pixel_of(y + row) - image.rect.y;
      for (int column = 0; column < tile_width; ++column) {
        const int u = setup.pixel_of(x + column) - image.rect.x;
        const bool known = u >= 0 && v >= 0 && u < image.rect.width && v < image.rect.height;
        depth[column] = known ? double(image.depth[std::size_t(v) * image.rect.width + u]) : beyond_every_depth;
      }
    }
    if (setup.steps && setup.steps->offsets)
      for (int column = 0; column < tile_width; ++column)
        begins[column] =
            setup.steps->first + setup.steps->offsets->at(setup.pixel_of(x + column), setup.pixel_of(y + row));
    HWY_DYNAMIC_DISPATCH(set_up_row)
    (setup, request.depth ? depth.data() : nullptr, begins.data(), request.depth && request.depth->or_equal,
     request.depth_range, x, y + row, inside ? width : 0, std::size_t(row) * tile_width, packet);
  }
  bool any_bound = false;
  for (int axis = 0; axis < 3; ++axis)
    any_bound = any_bound || setup.low_is_bound[axis] || setup.high_is_bound[axis];
  bool any = false;
  for (std::size_t r = 0; r < packet_rays; ++r) {
    if (any_bound && packet.first[r] <= packet.last[r]) keep_owned(setup, packet, r);
    any = any || packet.first[r] <= packet.last[r];
  }
  return any;
}

}  // namespace understudy::volume
#endif  // HWY_ONCE
