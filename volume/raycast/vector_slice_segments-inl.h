// SPDX-License-Identifier: Apache-2.0
// Slice segments and pre-integration tables in the vector kernels: a part of vector_kernel.cc and
// vector_segments-inl.h, included there once per instruction set, among the functions that they call.

/// The back positions of the segments whose fronts are the rays' current samples.
HWY_INLINE Position behind(const Packet& rays, const Constants& constants) {
  const Floats k = hn::Add(hn::Min(rays.k, rays.last), constants.samples_on);
  Position p;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats on_ray = hn::Add(hn::Mul(k, rays.step[axis]), rays.start[axis]);
    p.free[axis] = hn::Add(on_ray, constants.cells_away[axis]);
    p.clamped[axis] = hn::Min(hn::Max(p.free[axis], constants.held_low[axis]), constants.held_high[axis]);
  }
  return p;
}

/// A segment's position in the pre-integration table.
struct SegmentIndex {
  alignas(64) std::array<std::uint32_t, lanes> entry;  // of the lower corner, as an index of floats
  // Fractions of the distance to the next corner in the row, and to the next row.
  Floats across;
  alignas(64) std::array<float, lanes> up;
};

/// Position of a value on either axis of the pre-integration table: an entry, and the fraction of the distance
/// to the next.
struct AxisPlace {
  Ints entry;
  Floats between;
};

/// Splits a position from 0 to the last entry into entry and fraction.
HWY_INLINE AxisPlace between_entries(Floats place, const Constants& constants) {
  const Ints entry = hn::Min(truncated(place), constants.last_corner);
  return {entry, hn::Sub(place, hn::ConvertTo(FloatTag(), entry))};
}

HWY_INLINE AxisPlace place_on_axis(Floats value, const Constants& constants) {
  const Floats place = hn::Mul(hn::Sub(value, constants.table_low), constants.table_scale);
  const Floats kept = hn::Min(hn::Max(place, hn::Zero(FloatTag())), constants.table_last);  // 0 for NaN
  return between_entries(kept, constants);
}

HWY_INLINE Ints corner_of_pair(const AxisPlace& front, const AxisPlace& back, const Constants& constants) {
  return hn::Add(hn::Mul(back.entry, hn::Set(IntTag(), std::int32_t(constants.pair_row))), front.entry);
}

HWY_INLINE void set_pair(const AxisPlace& front, const AxisPlace& back, Ints corner, SegmentIndex& out) {
  const hn::RebindToUnsigned<IntTag> u;
  out.across = front.between;
  hn::Store(back.between, FloatTag(), out.up.data());
  hn::Store(hn::BitCast(u, hn::ShiftLeft<2>(corner)), u, out.entry.data());
}

/// Finds the position of two values in the pre-integration table. `absent` values and NaN leave the composite
/// unchanged.
template <typename Source>
HWY_INLINE void look_up_segment(Floats front, Floats back, hn::Mask<FloatTag> absent,
                                const Constants& constants, Source, SegmentIndex& out) {
  if constexpr (std::is_same_v<Source, Floats32>)
    absent = hn::Or(absent, hn::Or(hn::IsNaN(front), hn::IsNaN(back)));
  const AxisPlace x = place_on_axis(front, constants), y = place_on_axis(back, constants);
  const Ints corner = corner_of_pair(x, y, constants);
  const hn::Mask<IntTag> nothing = hn::RebindMask(IntTag(), absent);
  set_pair(x, y, hn::IfThenElse(nothing, constants.neutral_entry, corner), out);
}

template <typename Source>
HWY_INLINE void classify_slice_segment(const Located& front, const Located& back, const Packet& rays,
                                       const Constants& constants, Source source, SegmentIndex& out) {
  look_up_segment(value_of(front, constants, source), value_of(back, constants, source),
                  hn::Gt(rays.k, rays.last), constants, source, out);
}

template <std::size_t q>
HWY_INLINE Floats interpolated_segment(const SegmentIndex& at, const Constants& constants) {
  const FloatTag f;
  const std::size_t above = 4 * constants.pair_row;
  const Floats across = hn::Broadcast<q>(at.across);
  if constexpr (rows == 2) {
    // Adjacent entries: one load reads both corners of a ray.
    const auto upwards = [&](std::size_t ray) HWY_ATTR {
      const float* const corner = constants.entries + at.entry[ray];
      return mix(hn::LoadU(f, corner), hn::LoadU(f, corner + above), hn::Set(f, at.up[ray]));
    };
    const Floats first = upwards(q), second = upwards(q + 4);
    return mix(hn::ConcatLowerLower(f, second, first), hn::ConcatUpperUpper(f, second, first), across);
  } else {
    std::array<const float*, lanes> entries;
#pragma GCC unroll 4
    for (std::size_t row = 0; row < rows; ++row)
      entries[q + 4 * row] = constants.entries + at.entry[q + 4 * row];
    const auto along = [&](std::size_t offset) HWY_ATTR {
      return mix(load_column<q>(f, entries.data(), offset), load_column<q>(f, entries.data(), offset + 4),
                 across);
    };
    return mix(along(0), along(above), hn::Broadcast<q>(hn::Load(f, at.up.data())));
  }
}

template <std::size_t q>
HWY_INLINE Floats colour_at(const SegmentIndex& at, const Constants& constants) {
  const Floats colour = interpolated_segment<q>(at, constants);
  const Floats otherwise = hn::Sub(hn::Set(FloatTag(), 1.0F), constants.scaled_by_alpha);
  return hn::Mul(colour, hn::MulAdd(hn::Broadcast<3>(colour), constants.scaled_by_alpha, otherwise));
}
