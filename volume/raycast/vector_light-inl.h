// SPDX-License-Identifier: Apache-2.0
// Lights the samples of vector kernels: a part of vector_segments-inl.h, included there once per instruction
// set, among the functions that it calls.
//
// The cells one step ahead and one behind on an axis have the same interpolation fractions as the sample, so a
// central difference is the interpolated difference of their texels; for bytes it is exact before weighting. A
// neighbouring cell may lie in another block, which is determined lane by lane.

/// The positions of the cells adjacent to the rays' own, on one axis.
struct Neighbours {
  alignas(64) std::array<std::uint32_t, lanes> block, corner;
};

/// For column q only, so that its few pointers stay in registers.
template <std::size_t q, std::size_t bytes_per_texel>
HWY_INLINE Corners corners_of_column(const Neighbours& at, const Constants& constants) {
  Corners corners;
#pragma GCC unroll 4
  for (std::size_t lane = q; lane < lanes; lane += 4)
    corners[lane] = reinterpret_cast<const std::uint8_t*>(constants.blocks[at.block[lane]]) +
                    at.corner[lane] * bytes_per_texel;
  return corners;
}

/// Column q's edges in the cells ahead, minus those in the cells behind.
template <std::size_t q, typename Source>
HWY_INLINE Floats edge_differences(const Neighbours& ahead, const Neighbours& behind, const Located& at,
                                   const Constants& constants, Source source) {
  const Corners front = corners_of_column<q, Source::bytes>(ahead, constants);
  const Corners back = corners_of_column<q, Source::bytes>(behind, constants);
  if constexpr (std::is_same_v<Source, Bytes8>) {
    const ShortTag s;
    const auto difference =
        hn::Sub(hn::BitCast(s, edge_texels<q>(front)), hn::BitCast(s, edge_texels<q>(back)));
    return hn::ConvertTo(FloatTag(),
                         pairwise_products(hn::BitCast(IntTag(), difference), hn::Broadcast<q>(at.weights)));
  } else {
    return hn::Sub(edges_of_column<q>(front, at, constants, source),
                   edges_of_column<q>(back, at, constants, source));
  }
}

template <typename Source>
HWY_INLINE Floats difference_of(const Neighbours& ahead, const Neighbours& behind, const Located& at,
                                const Constants& constants, Source source) {
  std::array<Floats, 4> edges{edge_differences<0>(ahead, behind, at, constants, source),
                              edge_differences<1>(ahead, behind, at, constants, source),
                              edge_differences<2>(ahead, behind, at, constants, source),
                              edge_differences<3>(ahead, behind, at, constants, source)};
  transpose(edges);
  return mix(mix(edges[0], edges[1], at.y), mix(edges[2], edges[3], at.y), at.z);
}

/// The difference between the field one cell ahead and one behind on each axis, in the scale of field_at().
using Slope = std::array<Floats, 3>;

/// The cells around the rays' own.
struct Surroundings {
  Located at;
  std::array<Neighbours, 3> ahead, behind;
};

/// Returns false if some ray of `wanted` is less than a cell from the end of the held cells. Positions of other
/// rays are moved to where it is safe to read.
HWY_INLINE bool look_around(const Position& p, Mask wanted, const SegmentConstants& constants,
                            Surroundings& out) {
  const FloatTag f;
  const IntTag d;
  const hn::RebindToUnsigned<IntTag> u;
  Position inner;
  Mask outside = hn::Lt(hn::Zero(f), hn::Zero(f));
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    inner.free[axis] = inner.clamped[axis] =
        hn::Min(hn::Max(p.free[axis], constants.inner_low[axis]), constants.inner_high[axis]);
    outside = hn::Or(outside, hn::Ne(inner.clamped[axis], p.free[axis]));
  }
  if (!constants.has_inner || !hn::AllFalse(f, hn::And(outside, wanted))) return false;

  locate(inner, constants, out.at);
  const Ints block = hn::BitCast(d, hn::Load(u, out.at.block.data()));
  const Ints corner = hn::BitCast(d, hn::Load(u, out.at.corner.data()));
  constexpr std::array<std::int32_t, 3> strides{1, BrickStore::block_row, BrickStore::block_slice};
  constexpr std::int32_t last_cell = BrickStore::block_cells - 1;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Ints cell = hn::And(truncated(inner.clamped[axis]), hn::Set(d, last_cell));
    const Ints first = hn::VecFromMask(d, hn::Eq(cell, hn::Zero(d)));
    const Ints last = hn::VecFromMask(d, hn::Eq(cell, hn::Set(d, last_cell)));
    const Ints stride = hn::Set(d, strides[axis]), across = hn::Set(d, BrickStore::block_cells * strides[axis]);
    const auto store = [&](Ints of_block, Ints of_corner, Neighbours& to) HWY_ATTR {
      hn::Store(hn::BitCast(u, of_block), u, to.block.data());
      hn::Store(hn::BitCast(u, of_corner), u, to.corner.data());
    };
    store(hn::Add(block, hn::And(last, constants.blocks_along[axis])),
          hn::Sub(hn::Add(corner, stride), hn::And(last, across)), out.ahead[axis]);
    store(hn::Sub(block, hn::And(first, constants.blocks_along[axis])),
          hn::Add(hn::Sub(corner, stride), hn::And(first, across)), out.behind[axis]);
  }
  return true;
}

/// The field in the cells adjacent to the rays' own.
template <typename Source>
HWY_INLINE Floats value_beside(const Neighbours& beside, const Located& at, const Constants& constants,
                               Source source) {
  Located there = at;
  there.block = beside.block;
  there.corner = beside.corner;
  return value_of(there, constants, source);
}

template <typename Source>
HWY_INLINE void find_slope(const Surroundings& around, const SegmentConstants& constants, Source source,
                           Slope& slope) {
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if constexpr (std::is_same_v<Source, RoundedBytes8>) {
      // Each of the two values is rounded separately.
      slope[axis] = hn::Sub(value_beside(around.ahead[axis], around.at, constants, source),
                            value_beside(around.behind[axis], around.at, constants, source));
    } else {
      slope[axis] = difference_of(around.ahead[axis], around.behind[axis], around.at, constants, source);
    }
  }
}

/// For positions near the end of the held cells, where neighbouring positions are clamped, and for gradients
/// that reach farther or less far than to the next cell.
template <typename Source>
HWY_NOINLINE void find_clamped_slope(const Position& p, const SegmentConstants& constants, Source source,
                                     Slope& slope) {
  std::array<Located, 6> beside;
#pragma GCC unroll 6
  for (std::size_t i = 0; i < 6; ++i) {
    Position there;
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float reach = constants.reach[axis];
      const float away = axis != i / 2 ? 0.0F : i % 2 == 0 ? reach : -reach;
      there.free[axis] = hn::Add(p.free[axis], hn::Set(FloatTag(), away));
    }
    clamp_to_held(there, constants);
    locate(there, constants, beside[i]);
  }
#pragma GCC unroll 1
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats difference = hn::Sub(value_of(beside[2 * axis], constants, source),
                                      value_of(beside[2 * axis + 1], constants, source));
    slope[axis] = hn::Mul(difference, hn::Set(FloatTag(), 1 / constants.reach[axis]));
  }
}

/// Smaller squared gradients are rounding noise.
constexpr float least_square = 1e-30F;

/// How strongly points reflect the light: the cosine between normal and light, and the cosine between normal
/// and half vector, raised to the shininess.
struct Brightness {
  Floats diffuse, gleam;
  Floats lit;      // weight of the lit colour: 1, less where it fades, 0 without a gradient
  Floats opacity;  // factor by gradient length; only with gradient opacity
};

/// Gradient opacity for gradient lengths in the units of `metric`.
HWY_INLINE Floats gradient_opacity_of(Floats slope, const SegmentConstants& constants) {
  const FloatTag f;
  const IntTag d;
  const Floats unbound = hn::MulAdd(slope, constants.gradient_factors_a_slope, constants.first_gradient_factor);
  const Floats place = hn::Min(hn::Max(unbound, hn::Zero(f)), constants.end_of_gradient_factors);
  const Ints entry = hn::Min(truncated(place), constants.last_gradient_factor);
  const Floats share = hn::Sub(place, hn::ConvertTo(f, entry));
  return mix(hn::GatherIndex(f, constants.gradient_factors, entry),
             hn::GatherIndex(f, constants.gradient_factors, hn::Add(entry, hn::Set(d, 1))), share);
}

/// The light's response to cosines between -1 and 1.
HWY_INLINE void find_response(Floats cosine, const SegmentConstants& constants, Brightness& out) {
  const FloatTag f;
  const IntTag d;
  const Floats place = hn::MulAdd(cosine, constants.half_last_response, constants.half_last_response);
  const Ints entry = hn::Min(truncated(place), constants.last_response);
  const Floats share = hn::Sub(place, hn::ConvertTo(f, entry));
  const Ints from = hn::ShiftLeft<1>(entry);
  const auto at = [&](std::int32_t offset) HWY_ATTR {
    return hn::GatherIndex(f, constants.responses, hn::Add(from, hn::Set(d, offset)));
  };
  out.diffuse = mix(at(0), at(2), share);
  out.gleam = mix(at(1), at(3), share);
}

template <typename Source>
HWY_INLINE void find_cosines(const SegmentPacket& rays, const Slope& slope, const SegmentConstants& constants,
                             Source, Brightness& out) {
  const FloatTag f;
  const Floats zero = hn::Zero(f), one = hn::Set(f, 1.0F);
  Floats x = slope[0], y = slope[1], z = slope[2], size = one;
  if constexpr (std::is_same_v<Source, Floats32>) {
    // Squares may exceed the range of a float.
    const Floats largest = hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z)));
    size = hn::Max(largest, hn::Set(f, std::numeric_limits<float>::min()));
    const Floats unit = hn::Div(one, size);
    x = hn::Mul(x, unit);
    y = hn::Mul(y, unit);
    z = hn::Mul(z, unit);
  }
  const auto times = [&](Floats a, Floats b, Floats c)
                         HWY_ATTR { return hn::MulAdd(x, a, hn::MulAdd(y, b, hn::Mul(z, c))); };
  const std::array<Floats, 9>& m = constants.metric;
  const Floats square = times(times(m[0], m[1], m[2]), times(m[3], m[4], m[5]), times(m[6], m[7], m[8]));
  const Mask slopes = hn::And(hn::Gt(square, hn::Set(f, least_square)),
                              hn::Lt(square, hn::Set(f, std::numeric_limits<float>::max())));
  const Floats safe = hn::IfThenElse(slopes, square, one);
  // One Newton step refines the estimate to float precision.
  const Floats estimate = hn::ApproximateReciprocalSqrt(safe);
  const Floats rest = hn::NegMulAdd(hn::Mul(safe, estimate), estimate, one);
  const Floats unit = hn::MulAdd(hn::Mul(hn::Set(f, 0.5F), estimate), rest, estimate);
  if (constants.gradient_factors != nullptr)
    out.opacity =
        gradient_opacity_of(hn::IfThenElseZero(slopes, hn::Mul(size, hn::Mul(safe, unit))), constants);
  Floats inverse = unit;
  if (constants.is_guarded) {
    const Floats guard = hn::Div(constants.guard_in_slopes, size);
    const Floats own = hn::Mul(safe, unit);
    const Floats length = constants.guard_form == NormalGuard::Form::added ? hn::Add(own, guard)
                          : constants.guard_form == NormalGuard::Form::larger
                              ? hn::Max(own, guard)
                              : hn::Sqrt(hn::MulAdd(guard, guard, safe));
    inverse = hn::Div(one, length);
  }
  const auto projection = [&](const std::array<Floats, 3>& direction) HWY_ATTR {
    return hn::Mul(times(direction[0], direction[1], direction[2]), inverse);
  };
  const auto cosine = [&](const std::array<Floats, 3>& direction) HWY_ATTR {
    const Floats c = projection(direction);
    return hn::Min(constants.two_sided ? hn::Abs(c) : hn::Max(c, zero), one);
  };
  if (constants.responses != nullptr) {
    const Floats c = hn::IfThenElseZero(slopes, projection(rays.light));
    find_response(hn::Min(hn::Max(c, hn::Neg(one)), one), constants, out);
  } else {
    out.diffuse = cosine(rays.light);
    // Smaller cosines would only lead to denormal powers.
    out.gleam = hn::Max(cosine(rays.half), constants.least_cosine);
  }
  out.lit = hn::IfThenElseZero(slopes, one);
  if (!constants.fades) return;
  const Floats steepness = hn::Mul(hn::Mul(size, constants.share_of_slope), hn::Mul(safe, unit));
  out.lit = hn::IfThenElseZero(slopes, hn::Min(steepness, one));
}

/// Raises cosines to the shininess: to integers by squaring, to other exponents by logarithms. The inner loop
/// runs over points, which are independent.
template <std::size_t count>
HWY_INLINE void raise(const SegmentConstants& constants, std::array<Brightness, count>& points) {
  const FloatTag f;
  if (!constants.whole_shininess) {
    for (Brightness& at : points) at.gleam = hn::Exp(f, hn::Mul(constants.shininess, hn::Log(f, at.gleam)));
    return;
  }
  std::array<Floats, count> base;
  for (std::size_t i = 0; i < count; ++i) {
    base[i] = points[i].gleam;
    points[i].gleam = hn::Set(f, 1.0F);
  }
  for (unsigned left = *constants.whole_shininess; left != 0; left >>= 1U)
    for (std::size_t i = 0; i < count; ++i) {
      if ((left & 1U) != 0) points[i].gleam = hn::Mul(points[i].gleam, base[i]);
      base[i] = hn::Mul(base[i], base[i]);
    }
}

HWY_INLINE void light_up(const Brightness& at, const SegmentConstants& constants, Colours& colours) {
  const FloatTag f;
  const auto shown = [&](Floats colour, Floats bright, Floats gleam) HWY_ATTR {
    const Floats share = hn::MulAdd(constants.diffuse, bright, constants.ambient);
    const Floats white = hn::Mul(hn::Mul(constants.specular, gleam), hn::Broadcast<3>(colour));
    const Floats lit = hn::MulAdd(colour, share, white);
    return constants.has_brightest ? hn::Min(lit, hn::Mul(constants.brightest, hn::Broadcast<3>(colour))) : lit;
  };
  const Floats first = shown(colours[0], hn::Broadcast<0>(at.diffuse), hn::Broadcast<0>(at.gleam));
  const Floats second = shown(colours[1], hn::Broadcast<1>(at.diffuse), hn::Broadcast<1>(at.gleam));
  const Floats third = shown(colours[2], hn::Broadcast<2>(at.diffuse), hn::Broadcast<2>(at.gleam));
  const Floats fourth = shown(colours[3], hn::Broadcast<3>(at.diffuse), hn::Broadcast<3>(at.gleam));
  const Floats zero = hn::Zero(f);
  const bool all_lit = hn::AllTrue(f, hn::Ge(at.lit, hn::Set(f, 1.0F)));
  const auto put = [&](Floats lit, Floats with, Floats& colour) HWY_ATTR {
    const Floats even = hn::Mul(constants.even, colour);
    colour = all_lit ? with : hn::IfThenElse(hn::Gt(lit, zero), mix(even, with, lit), even);
  };
  put(hn::Broadcast<0>(at.lit), first, colours[0]);
  put(hn::Broadcast<1>(at.lit), second, colours[1]);
  put(hn::Broadcast<2>(at.lit), third, colours[2]);
  put(hn::Broadcast<3>(at.lit), fourth, colours[3]);
  if (constants.gradient_factors == nullptr) return;
  colours[0] = hn::Mul(colours[0], hn::Broadcast<0>(at.opacity));
  colours[1] = hn::Mul(colours[1], hn::Broadcast<1>(at.opacity));
  colours[2] = hn::Mul(colours[2], hn::Broadcast<2>(at.opacity));
  colours[3] = hn::Mul(colours[3], hn::Broadcast<3>(at.opacity));
}

/// Lights the points p of the rays of `wanted`; `colours` holds their colours.
template <typename Source>
HWY_NOINLINE void lay_in_light(const SegmentPacket& rays, const Position& p, Mask wanted,
                               const SegmentConstants& constants, Source source, Colours& colours) {
  Surroundings around;
  Slope slope;
  if (look_around(p, wanted, constants, around)) {
    find_slope(around, constants, source, slope);
  } else {
    find_clamped_slope(p, constants, source, slope);
  }
  std::array<Brightness, 1> bright;
  find_cosines(rays, slope, constants, source, bright[0]);
  if (constants.gleams) raise(constants, bright);
  light_up(bright[0], constants, colours);
}
