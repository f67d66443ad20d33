// SPDX-License-Identifier: Apache-2.0
// The generic segment kernel on the vector instructions of the machine, eight segments of every ray at a time,
// as vector_kernel.cc takes samples. Rare cases (surfaces, the ends of rays) are handled segment by segment. A
// part of vector_segments.cc and vector_pre_integrated_segments.cc, included there once per instruction set.

#include "volume/raycast/vector_field-inl.h"
#include "volume/raycast/vector_layer-inl.h"
#include "volume/raycast/vector_slice_segments-inl.h"

using Mask = hn::Mask<FloatTag>;

/// Constants of a frame for segments, as vectors.
struct SegmentConstants : Constants {
  template <typename Source>
  SegmentConstants(const Scene& scene, Source source) : Constants(scene, source) {
    const FloatTag f;
    const SegmentScene& segments = *scene.segments;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      held_low[axis] = hn::Set(f, scene.held_low[axis]);
      held_high[axis] = hn::Set(f, scene.held_high[axis]);
    }
    values_beyond = scene.values_beyond;
    levels = segments.levels.size();
    for (std::size_t i = 0; i < levels; ++i) {
      level[i] = hn::Set(f, Source::factor * (segments.levels[i].value - Source::zero));
      surface[i] = hn::LoadDup128(f, segments.levels[i].colour.data());
    }
    prepared_light = segments.prepared_light ? &*segments.prepared_light : nullptr;
    if (prepared_light == nullptr) return;
    set_neighbourhood(scene);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reach[axis] = prepared_light->reach[axis];
      has_inner = has_inner && reach[axis] == 1;
    }
    // Normalised to magnitudes near one, so that squared slopes stay far from the limits of a float.
    const std::array<float, 9>& of_light = prepared_light->metric;
    const float unit = 1 / std::sqrt(std::max({of_light[0], of_light[4], of_light[8]}));
    for (std::size_t i = 0; i < 9; ++i) metric[i] = hn::Set(f, of_light[i] * unit * unit);
    normal_of_slope = Source::factor < 0 ? unit : -unit;
    // Differences span two cells.
    fades = segments.prepared_light->full_slope > 0;
    if (fades)
      share_of_slope = hn::Set(
          f, std::min(1 / (2 * std::abs(Source::factor) * unit * segments.prepared_light->full_slope), 1e30F));
    const NormalGuard& guard = prepared_light->guard;
    is_guarded = guard.slope > 0;
    guard_form = guard.form;
    if (is_guarded)
      guard_in_slopes =
          hn::Set(f, float(std::min(2 * double(std::abs(Source::factor)) * double(unit) * guard.slope,
                                    double(std::numeric_limits<float>::max()))));
    const GradientOpacity& opacity = prepared_light->gradient_opacity;
    if (!opacity.factors.empty()) {
      gradient_factors = opacity.factors.data();
      last_gradient_factor = hn::Set(IntTag(), std::int32_t(opacity.factors.size() - 2));
      end_of_gradient_factors = hn::Set(f, float(opacity.factors.size() - 1));
      const double factors_a_slope = double(opacity.factors.size() - 1) / (opacity.last - opacity.first);
      // Bounded, so that a very narrow range does not overflow.
      gradient_factors_a_slope = hn::Set(
          f, float(std::min(factors_a_slope / (2 * double(std::abs(Source::factor)) * double(unit)), 1e30)));
      first_gradient_factor = hn::Set(f, float(std::clamp(-opacity.first * factors_a_slope, -1e30, 1e30)));
    }
    two_sided = prepared_light->model.two_sided;
    const auto colour = [&](const std::array<float, 3>& rgb, float alpha) HWY_ATTR {
      alignas(16) const float components[4] = {rgb[0], rgb[1], rgb[2], alpha};
      return hn::LoadDup128(f, components);
    };
    ambient = colour(prepared_light->model.ambient, 1);
    diffuse = colour(prepared_light->model.diffuse, 0);
    specular = colour(prepared_light->model.specular, 0);
    const float exponent = prepared_light->model.shininess;
    constexpr float largest_whole = 1024;
    if (exponent <= largest_whole && exponent == std::floor(exponent)) whole_shininess = unsigned(exponent);
    shininess = hn::Set(f, exponent);
    least_cosine = hn::Set(f, std::max(std::exp(-40 / exponent), 1e-30F));
    gleams = prepared_light->model.specular != std::array<float, 3>{};
    even = colour(prepared_light->model.even, 1);
    has_brightest = std::isfinite(prepared_light->model.brightest);
    const float most = prepared_light->model.brightest;
    brightest = colour({most, most, most}, 1);
    const std::vector<LightResponse>& response = prepared_light->model.response;
    if (response.empty()) return;
    responses = &response.front().diffuse;
    half_last_response = hn::Set(f, 0.5F * float(response.size() - 1));
    last_response = hn::Set(IntTag(), std::int32_t(response.size() - 2));
    gleams = false;
  }

  /// Sets the range of cells whose neighbours are held, and the index distances between neighbouring blocks.
  void set_neighbourhood(const Scene& scene) {
    const FloatTag f;
    const auto& counts = scene.store->block_counts();
    std::int32_t blocks = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = scene.held_low[axis] + 1, high = scene.held_high[axis] - 1;
      has_inner = has_inner && low <= high;
      inner_low[axis] = hn::Set(f, low);
      inner_high[axis] = hn::Set(f, high);
      blocks_along[axis] = hn::Set(IntTag(), blocks);
      blocks *= counts[axis];
    }
  }

  std::array<Floats, 3> held_low, held_high;
  bool values_beyond = false;
  std::size_t levels = 0;
  std::array<Floats, max_surfaces> level;    // in the scale of field_at()
  std::array<Floats, max_surfaces> surface;  // components side by side

  const PreparedLight* prepared_light = nullptr;
  std::array<Floats, 9> metric;
  float normal_of_slope = 1;  // scale of `light` and `half` that matches `metric` and the sign of slopes
  Floats ambient, diffuse, specular;  // components side by side
  Floats shininess, least_cosine;
  std::optional<unsigned> whole_shininess;
  bool gleams = false, two_sided = false;
  Floats even;  // factor for points without a gradient; components side by side
  bool has_brightest = false;
  Floats brightest;                  // times opacity; components side by side
  const float* responses = nullptr;  // pairs of diffuse and specular; null: Blinn-Phong
  Floats half_last_response;
  Ints last_response;       // the last but one entry
  bool is_guarded = false;  // normals may be shorter than 1
  NormalGuard::Form guard_form{};
  Floats guard_in_slopes;                   // in the units of `metric`
  bool fades = false;                       // where slopes are less than the light's full slope
  Floats share_of_slope;                    // factor for slopes in the units of `metric`
  const float* gradient_factors = nullptr;  // null: opacity does not depend on slopes
  Ints last_gradient_factor;                // the last but one
  Floats gradient_factors_a_slope;          // in the units of `metric`
  Floats first_gradient_factor, end_of_gradient_factors;

  std::array<Floats, 3> inner_low, inner_high;  // one cell away from the ends of the held cells
  bool has_inner = true;                        // they exist, and gradients reach exactly to the next cell
  std::array<float, 3> reach{1, 1, 1};
  std::array<Ints, 3> blocks_along;  // index distance of neighbouring blocks on each axis
};

/// A packet for segments. If `known`, `value` is the field at the front of the next segment.
struct SegmentPacket : Packet {
  Floats begin, end;
  std::array<Floats, 3> light, half;
  Floats value;
  bool known = false;
};
using SegmentGroup = std::array<SegmentPacket, group>;

/// The position where segment k begins, in steps.
HWY_INLINE Floats on_ray(const SegmentPacket& rays, Floats k) {
  // Finished rays stay behind their last segment, where it is safe to read.
  const Floats counted = hn::Min(k, hn::Add(rays.last, hn::Set(FloatTag(), 1.0F)));
  return hn::Min(hn::Max(counted, rays.begin), rays.end);
}

HWY_INLINE void clamp_to_held(Position& p, const SegmentConstants& constants) {
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    p.clamped[axis] = hn::Min(hn::Max(p.free[axis], constants.held_low[axis]), constants.held_high[axis]);
}

HWY_INLINE Position place_at(const SegmentPacket& rays, Floats u, const SegmentConstants& constants) {
  Position p;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    p.free[axis] = hn::Add(hn::Mul(u, rays.step[axis]), rays.start[axis]);
  clamp_to_held(p, constants);
  return p;
}

template <typename Source>
HWY_INLINE Floats value_at(const Position& p, const SegmentConstants& constants, Source source) {
  Located at;
  locate(p, constants, at);
  return value_of(at, constants, source);
}

/// Skips the segments that lie completely in empty bricks. Returns false if there were none.
HWY_INLINE bool skip_empty_runs_of_segments(SegmentPacket& rays, const SegmentConstants& constants) {
  const FloatTag f;
  const IntTag d;
  const Floats half = hn::Set(f, 0.5F), one = hn::Set(f, 1.0F);
  const Floats u = on_ray(rays, rays.k);
  const Position p = place_at(rays, u, constants);
  std::array<Ints, 3> block;
  std::array<Floats, 3> steps_to_face;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats blocks = hn::Mul(p.clamped[axis], hn::Set(f, 1.0F / BrickStore::block_cells));
    block[axis] = truncated(blocks);
    const Floats in_block = hn::Sub(hn::Sub(blocks, hn::ConvertTo(f, block[axis])), half);
    const Floats room = hn::Sub(hn::NegMulSub(rays.direction[axis], in_block, half), constants.rounding[axis]);
    steps_to_face[axis] = hn::Mul(room, rays.steps_per_block[axis]);
  }
  const Ints index = block_index(block[0], block[1], block[2], constants);
  const Floats distance =
      hn::ConvertTo(f, hn::And(hn::GatherOffset(d, constants.distances, index), hn::Set(d, 255)));
  Floats steps = hn::Set(f, 1e9F);
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    steps = hn::Min(steps, hn::MulAdd(distance, rays.steps_per_block[axis], steps_to_face[axis]));
  const Floats next = hn::Min(hn::Floor(hn::Add(u, hn::Max(steps, hn::Zero(f)))), hn::Add(rays.last, one));
  const auto empty = hn::And(hn::Gt(distance, hn::Zero(f)), hn::Gt(next, rays.k));
  rays.k = hn::IfThenElse(empty, next, rays.k);
  return !hn::AllFalse(f, empty);
}

/// For differences between values in the scale of field_at() and that of a surface.
template <typename Source>
HWY_INLINE Mask is_above(Floats difference) {
  const Floats zero = hn::Zero(FloatTag());
  return Source::factor < 0 ? hn::Le(difference, zero) : hn::Ge(difference, zero);
}

template <typename Source>
HWY_INLINE Mask passes(Floats front, Floats back, Floats level) {
  const Mask other = hn::Xor(is_above<Source>(hn::Sub(front, level)), is_above<Source>(hn::Sub(back, level)));
  if constexpr (std::is_same_v<Source, Floats32>)
    return hn::And(other, hn::Not(hn::Or(hn::IsNaN(front), hn::IsNaN(back))));
  return other;
}

/// Clears the colours of rays outside a mask (1 or 0 in each lane).
HWY_INLINE void keep(Floats shown, Colours& colours) {
  const FloatTag f;
  const Floats zero = hn::Zero(f);
  colours[0] = hn::IfThenElseZero(hn::Gt(hn::Broadcast<0>(shown), zero), colours[0]);
  colours[1] = hn::IfThenElseZero(hn::Gt(hn::Broadcast<1>(shown), zero), colours[1]);
  colours[2] = hn::IfThenElseZero(hn::Gt(hn::Broadcast<2>(shown), zero), colours[2]);
  colours[3] = hn::IfThenElseZero(hn::Gt(hn::Broadcast<3>(shown), zero), colours[3]);
}

/// Whether any of the rays has a colour.
HWY_INLINE bool show(const Colours& colours) {
  const FloatTag f;
  const Floats zero = hn::Zero(f);
  const auto either = [&](std::size_t a, std::size_t b)
                          HWY_ATTR { return hn::Or(hn::Ne(colours[a], zero), hn::Ne(colours[b], zero)); };
  return !hn::AllFalse(f, hn::Or(either(0, 1), either(2, 3)));
}

/// Converts colours of layers one step long to layers of `length` steps, at most 1.
HWY_INLINE void shorten(Floats length, Colours& colours) {
  const Floats one = hn::Set(FloatTag(), 1.0F);
  multiply(hn::IfThenElse(hn::Lt(length, one), share_of_layer(length, alphas(colours)), one), colours);
}

HWY_INLINE void compose_over(const Colours& colours, Colours& pixels) {
#pragma GCC unroll 4
  for (std::size_t q = 0; q < 4; ++q) pixels[q] = composed<Operator::over>(pixels[q], colours[q]);
}

/// Composites a sample that represents a whole step.
HWY_INLINE void compose_sample(const Colours& colours, const Constants& constants, Colours& pixels) {
  if (!constants.is_limited) return compose_over(colours, pixels);
#pragma GCC unroll 4
  for (std::size_t q = 0; q < 4; ++q)
    pixels[q] = composed_to_limit(pixels[q], colours[q], constants.opacity_limit);
}

template <typename Classified>
HWY_INLINE void colours_of(const Classified& at, const Constants& constants, Colours& out) {
  out[0] = colour_at<0>(at, constants);
  out[1] = colour_at<1>(at, constants);
  out[2] = colour_at<2>(at, constants);
  out[3] = colour_at<3>(at, constants);
}

#include "volume/raycast/vector_light-inl.h"

/// One segment of every ray: its ends in steps, in space and in value.
struct Segment {
  Floats begin, end;
  Position from, to;
  Floats front, back;
  Floats cells;  // its length

  Position point(Floats share, const SegmentConstants& constants) const {
    Position p;
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis)
      p.free[axis] = hn::Add(from.free[axis], hn::Mul(share, hn::Sub(to.free[axis], from.free[axis])));
    clamp_to_held(p, constants);
    return p;
  }
};

/// SurfaceSearch for the rays of `sought`, behind `front`, where the field is `at_front`. Clears the lanes of
/// `sought` whose field value is NaN.
template <typename Source>
HWY_INLINE Floats find_surface(const Segment& segment, Floats front, Floats at_front, Floats level,
                               const SegmentConstants& constants, Source source, Mask& sought) {
  const FloatTag f;
  const Floats zero = hn::Zero(f), half = hn::Set(f, 0.5F), tolerance = hn::Set(f, surface_tolerance);
  const Floats nudge = hn::Div(hn::Mul(hn::Set(f, surface_nudge), tolerance), segment.cells);
  Floats a = front, b = hn::Set(f, 1.0F);
  Floats at_a = hn::Sub(at_front, level), at_b = hn::Sub(segment.back, level);
  const Mask above = is_above<Source>(at_a);
  Mask front_moved = hn::Lt(zero, zero), back_moved = front_moved;
  const auto wide = [&] { return hn::Gt(hn::Mul(hn::Sub(b, a), segment.cells), tolerance); };
  Mask searching = hn::And(sought, wide());
  for (int round = 0; round < false_positions + bisections && !hn::AllFalse(f, searching); ++round) {
    Floats share = hn::Mul(half, hn::Add(a, b));
    if (round < false_positions) {
      share = hn::Sub(b, hn::Mul(at_b, hn::Div(hn::Sub(b, a), hn::Sub(at_b, at_a))));
      share = hn::IfThenElse(hn::Eq(at_a, zero), hn::Add(a, nudge), share);
      share = hn::IfThenElse(hn::Eq(at_b, zero), hn::Sub(b, nudge), share);
      share = hn::IfThenElse(hn::Gt(share, a), hn::Min(share, b), a);
    }
    const Floats there = hn::Sub(value_at(segment.point(share, constants), constants, source), level);
    if constexpr (std::is_same_v<Source, Floats32>) {
      const Mask lost = hn::And(searching, hn::IsNaN(there));
      sought = hn::And(sought, hn::Not(lost));
      searching = hn::And(searching, hn::Not(lost));
    }
    const Mask other_side = hn::Xor(is_above<Source>(there), above);
    const Mask move_back = hn::And(searching, other_side);
    const Mask move_front = hn::And(searching, hn::Not(other_side));
    at_b = hn::IfThenElse(hn::And(move_front, front_moved), hn::Mul(half, at_b), at_b);
    at_a = hn::IfThenElse(hn::And(move_back, back_moved), hn::Mul(half, at_a), at_a);
    at_a = hn::IfThenElse(move_front, there, at_a);
    at_b = hn::IfThenElse(move_back, there, at_b);
    a = hn::IfThenElse(move_front, share, a);
    b = hn::IfThenElse(move_back, share, b);
    front_moved = move_front;
    back_moved = move_back;
    searching = hn::And(searching, wide());
  }
  return hn::Mul(half, hn::Add(a, b));
}

/// A segment between two values, in positions in the table.
struct PlacedEnds {
  Floats from, to;     // may lie beyond the table
  Floats first, last;  // clamped to the table

  PlacedEnds(Floats front, Floats back, const Constants& constants) {
    const FloatTag f;
    // Keeps differences of positions finite.
    const Floats far = hn::Set(f, 1e18F);
    const auto place = [&](Floats value) HWY_ATTR {
      const Floats free = hn::Mul(hn::Sub(value, constants.table_low), constants.table_scale);
      return hn::Min(hn::Max(free, hn::Neg(far)), far);
    };
    const auto kept = [&](Floats at)
                          HWY_ATTR { return hn::Min(hn::Max(at, hn::Zero(f)), constants.table_last); };
    from = place(front);
    to = place(back);
    first = kept(from);
    last = kept(to);
  }

  /// Whether the segment crosses an end of the table.
  Mask part() const {
    const Floats beyond = hn::Max(hn::Abs(hn::Sub(from, first)), hn::Abs(hn::Sub(to, last)));
    return hn::And(hn::Ne(first, last), hn::Gt(beyond, hn::Set(FloatTag(), table_end_slack)));
  }
};

/// Colour of `length` steps between two positions in the table; none for `absent` rays. A part of a step is
/// more homogeneous than the whole, where the front attenuates the light of the back: to second order, its
/// colour is a mean of the segment's and of its mirror image's.
HWY_INLINE void show_stretch(Floats front, Floats back, Floats length, Mask absent, const Constants& constants,
                             Colours& out) {
  const FloatTag f;
  const Floats one = hn::Set(f, 1.0F);
  const AxisPlace x = between_entries(front, constants), y = between_entries(back, constants);
  const hn::Mask<IntTag> nothing = hn::RebindMask(IntTag(), absent);
  const auto look_up = [&](const AxisPlace& a, const AxisPlace& b, Colours& colours) HWY_ATTR {
    SegmentIndex place;
    set_pair(a, b, hn::IfThenElse(nothing, constants.neutral_entry, corner_of_pair(a, b, constants)), place);
    colours_of(place, constants, colours);
  };
  look_up(x, y, out);
  if (hn::AllTrue(f, hn::Or(absent, hn::Ge(length, one)))) return;
  Colours mirrored;
  look_up(y, x, mirrored);
  const Floats share = hn::Max(hn::Mul(hn::Set(f, 0.5F), hn::Sub(one, length)), hn::Zero(f));
  out[0] = mix(out[0], mirrored[0], hn::Broadcast<0>(share));
  out[1] = mix(out[1], mirrored[1], hn::Broadcast<1>(share));
  out[2] = mix(out[2], mirrored[2], hn::Broadcast<2>(share));
  out[3] = mix(out[3], mirrored[3], hn::Broadcast<3>(share));
  shorten(length, out);
}

/// Colour of `length` steps on which the field varies linearly between two values. Beyond either end of the
/// table, the entry at that end applies, so the segment is split there.
template <typename Source>
HWY_NOINLINE void show_between(Floats front, Floats back, Floats length, Mask absent,
                               const SegmentConstants& constants, Source, Colours& out) {
  const FloatTag f;
  const Floats zero = hn::Zero(f), one = hn::Set(f, 1.0F);
  if constexpr (std::is_same_v<Source, Floats32>)
    absent = hn::Or(absent, hn::Or(hn::IsNaN(front), hn::IsNaN(back)));
  const PlacedEnds ends(front, back, constants);
  const Mask parted = hn::And(ends.part(), hn::Not(absent));
  if (!constants.values_beyond || hn::AllFalse(f, parted))
    return show_stretch(ends.first, ends.last, length, absent, constants, out);
  const Floats way = hn::IfThenElse(parted, hn::Sub(ends.to, ends.from), one);
  const auto share = [&](Floats place, Floats otherwise) HWY_ATTR {
    return hn::IfThenElse(parted, hn::Div(hn::Sub(place, ends.from), way), otherwise);
  };
  const Floats enters = share(ends.first, zero), leaves = share(ends.last, one);
  out.fill(zero);
  Colours part;
  show_stretch(ends.first, ends.first, hn::Mul(enters, length), absent, constants, part);
  compose_over(part, out);
  show_stretch(ends.first, ends.last, hn::Mul(hn::Sub(leaves, enters), length), absent, constants, part);
  compose_over(part, out);
  show_stretch(ends.last, ends.last, hn::Mul(hn::Sub(one, leaves), length), absent, constants, part);
  compose_over(part, out);
}

/// Composites a pre-integrated piece of a segment in the rays of `shown`.
template <typename Source>
HWY_INLINE void compose_piece(const SegmentPacket& rays, const Segment& segment, Floats begin, Floats end,
                              Floats at_begin, Floats at_end, Mask shown, bool lit,
                              const SegmentConstants& constants, Source source, Colours& pixels) {
  const Floats length = hn::Mul(hn::Sub(end, begin), hn::Sub(segment.end, segment.begin));
  Colours colours;
  show_between(at_begin, at_end, length, hn::Not(shown), constants, source, colours);
  if (lit) {
    const Floats middle = hn::Mul(hn::Set(FloatTag(), 0.5F), hn::Add(begin, end));
    lay_in_light(rays, segment.point(middle, constants), shown, constants, source, colours);
  }
  compose_over(colours, pixels);
}

/// Composites the surfaces in a segment of the rays of `present`, and what lies between them: parts of the
/// segment if `pre_integrated`, otherwise parts of the layer, one step long, that the sample at its front
/// represents.
template <bool pre_integrated, typename Source>
HWY_NOINLINE void compose_surfaces(const SegmentPacket& rays, const Segment& segment, const Mask& present,
                                   bool lit, const SegmentConstants& constants, Source source,
                                   const Colours& layer, Colours& pixels) {
  const FloatTag f;
  Floats front = hn::Zero(f), at_front = segment.front;
  const Floats steps = hn::Sub(segment.end, segment.begin);
  const auto compose_layer = [&](Floats length) HWY_ATTR {
    Colours part = layer;
    shorten(length, part);
    compose_over(part, pixels);
  };
  const Mask rising =
      Source::factor < 0 ? hn::Gt(segment.front, segment.back) : hn::Lt(segment.front, segment.back);
  for (const bool rise : {true, false}) {
    const Mask these = hn::And(present, rise ? rising : hn::Not(rising));
    for (std::size_t i = 0; i < constants.levels; ++i) {
      const std::size_t which = rise ? i : constants.levels - 1 - i;
      const Floats level = constants.level[which];
      Mask sought = hn::And(these, passes<Source>(segment.front, segment.back, level));
      if (hn::AllFalse(f, sought)) continue;
      const Floats found = find_surface(segment, front, at_front, level, constants, source, sought);
      if constexpr (pre_integrated) {
        compose_piece(rays, segment, front, found, at_front, level, sought, lit, constants, source, pixels);
      } else {
        compose_layer(hn::IfThenElseZero(sought, hn::Mul(hn::Sub(found, front), steps)));
      }
      Colours colours;
      colours.fill(constants.surface[which]);
      keep(hn::IfThenElseZero(sought, hn::Set(f, 1.0F)), colours);
      if (constants.prepared_light != nullptr)
        lay_in_light(rays, segment.point(found, constants), sought, constants, source, colours);
      compose_over(colours, pixels);
      front = hn::IfThenElse(sought, found, front);
      at_front = hn::IfThenElse(sought, level, at_front);
    }
  }
  if constexpr (pre_integrated) {
    compose_piece(rays, segment, front, hn::Set(f, 1.0F), at_front, segment.back, present, lit, constants,
                  source, pixels);
  } else {
    compose_layer(hn::NegMulAdd(front, steps, hn::Set(f, 1.0F)));
  }
}

/// A whole segment's position in a pre-integration table with premultiplied entries.
struct SegmentPlace : SegmentIndex {};

template <std::size_t q>
HWY_INLINE Floats colour_at(const SegmentPlace& at, const Constants& constants) {
  return interpolated_segment<q>(at, constants);
}

#include "volume/raycast/vector_segment_blocks-inl.h"
