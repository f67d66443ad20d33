// Slabs and tables of pairs in the vector kernels: a part of vector_kernel.cc and vector_segments.cc, included
// there once per instruction set, among the functions that they call.

/// The backs of the slabs whose fronts are the rays' samples.
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

/// A slab's place in the table of pairs.
struct PairPlace {
  alignas(64) std::array<std::uint32_t, lanes> entry;  // of the lower corner, as an index of floats
  Floats across, up;                                   // fractions of the way to the corners beside and above
};

/// Where two values stand in the table of pairs; `absent` ones leave the composite as it is, and so do those
/// that are no number.
template <typename Source>
HWY_INLINE void look_up_pair(Floats front, Floats back, hn::Mask<FloatTag> absent, const Constants& constants,
                             Source, PairPlace& out) {
  const FloatTag f;
  const IntTag d;
  const auto corner_of = [&](Floats value, Floats& between) HWY_ATTR {
    if constexpr (std::is_same_v<Source, Floats32>) absent = hn::Or(absent, hn::IsNaN(value));
    const Floats place = hn::Mul(hn::Sub(value, constants.table_low), constants.table_scale);
    const Floats kept = hn::Min(hn::Max(place, hn::Zero(f)), constants.table_last);
    const Ints corner = hn::Min(truncated(kept), constants.last_corner);
    between = hn::Sub(kept, hn::ConvertTo(f, corner));
    return corner;
  };
  const Ints x = corner_of(front, out.across), y = corner_of(back, out.up);
  const Ints corner = hn::Add(hn::Mul(y, hn::Set(d, std::int32_t(constants.pair_row))), x);
  const hn::RebindToUnsigned<IntTag> u;
  const Ints chosen = hn::IfThenElse(hn::RebindMask(d, absent), constants.neutral_entry, corner);
  out.across = hn::IfThenElseZero(hn::Not(absent), out.across);  // no number must not get into a sum
  out.up = hn::IfThenElseZero(hn::Not(absent), out.up);
  hn::Store(hn::BitCast(u, hn::ShiftLeft<2>(chosen)), u, out.entry.data());
}

template <typename Source>
HWY_INLINE void classify_slab(const Located& front, const Located& back, const Packet& rays,
                              const Constants& constants, Source source, PairPlace& out) {
  look_up_pair(value_of(front, constants, source), value_of(back, constants, source), hn::Gt(rays.k, rays.last),
               constants, source, out);
}

template <std::size_t q>
HWY_INLINE Floats colour_at(const PairPlace& at, const Constants& constants) {
  const FloatTag f;
  std::array<const float*, lanes> entries;
#pragma GCC unroll 4
  for (std::size_t row = 0; row < rows; ++row) entries[q + 4 * row] = constants.entries + at.entry[q + 4 * row];
  const std::size_t above = 4 * constants.pair_row;
  const Floats across = hn::Broadcast<q>(at.across);
  const auto along = [&](std::size_t offset) HWY_ATTR {
    return mix(load_column<q>(f, entries.data(), offset), load_column<q>(f, entries.data(), offset + 4),
               across);
  };
  const Floats colour = mix(along(0), along(above), hn::Broadcast<q>(at.up));
  const Floats one = hn::Set(f, 1.0F);
  const Floats less = hn::Sub(hn::Broadcast<3>(colour), one);
  return hn::Mul(colour, hn::MulAdd(less, constants.scaled_by_alpha, one));
}
