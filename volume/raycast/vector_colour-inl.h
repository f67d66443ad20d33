// SPDX-License-Identifier: Apache-2.0
// What samples add to the pixels of their rays: positions in the transfer function, colours, and blending. A
// part of vector_field-inl.h, included there once per instruction set, after the field.

/// The contribution of a scalar sample to its ray's pixel: a position in the table, whose entries are loaded
/// during blending.
struct TablePlace {
  alignas(64) std::array<std::uint32_t, lanes> entry;  // as an index of floats
  Floats between;                                      // fraction of the distance to the next entry
};

/// Premultiplied colours, components side by side, one vector per column.
using Colours = std::array<Floats, 4>;

/// Finds the position of a value in the transfer function. `absent` values and NaN leave the composite
/// unchanged.
template <typename Source>
HWY_INLINE void look_up(Floats value, hn::Mask<FloatTag> absent, const Constants& constants, Source,
                        TablePlace& out) {
  const FloatTag f;
  const IntTag d;
  const Floats place = hn::Mul(hn::Sub(value, constants.table_low), constants.table_scale);
  const Floats kept = hn::Min(hn::Max(place, hn::Zero(f)), constants.table_last);
  const Ints entry = truncated(kept);
  out.between = hn::Sub(kept, hn::ConvertTo(f, entry));
  if constexpr (std::is_same_v<Source, Floats32>) absent = hn::Or(absent, hn::IsNaN(value));
  const hn::RebindToUnsigned<IntTag> u;
  const Ints chosen = hn::IfThenElse(hn::RebindMask(d, absent), constants.neutral_entry, entry);
  hn::Store(hn::BitCast(u, hn::ShiftLeft<3>(chosen)), u, out.entry.data());
}

/// The field at a located sample, including its border.
template <typename Source>
HWY_INLINE Floats value_of(const Located& at, const Constants& constants, Source source) {
  const Floats value = field_at(at, constants, source);
  return constants.with_border ? mix(constants.border, value, at.border_weight) : value;
}

template <typename Source>
HWY_INLINE void classify(const Located& at, const Packet& rays, const Constants& constants, Source source,
                         TablePlace& out) {
  look_up(value_of(at, constants, source), hn::Gt(rays.k, rays.last), constants, source, out);
}

/// Texels of four bytes: one edge of the cells of column q's rays, interpolated along x, per component.
template <std::size_t q>
HWY_INLINE Floats colour_edge(const Corners& corners, std::size_t offset, Ints weights) {
  const ByteTag d;
  // Reds, greens, blues and alphas of both texels side by side, widened to 16 bits.
  alignas(16) static constexpr std::uint8_t interleave[16] = {0, 128, 4, 128, 1, 128, 5, 128,
                                                              2, 128, 6, 128, 3, 128, 7, 128};
  const Bytes both =
      hn::TableLookupBytesOr0(load_column<q>(d, corners.data(), offset), hn::LoadDup128(d, interleave));
  return hn::ConvertTo(FloatTag(), pairwise_products(hn::BitCast(IntTag(), both), hn::Broadcast<q>(weights)));
}

template <std::size_t q>
HWY_INLINE Floats colour_of_column(const Corners& corners, const Located& at, Floats present,
                                   const Constants& constants) {
  const FloatTag f;
  std::array<Floats, 4> edges;
#pragma GCC unroll 4
  for (std::size_t edge = 0; edge < 4; ++edge)
    edges[edge] = colour_edge<q>(corners, 4 * edge_offsets[edge], at.weights);
  const Floats y = hn::Broadcast<q>(at.y);
  Floats texel = mix(mix(edges[0], edges[1], y), mix(edges[2], edges[3], y), hn::Broadcast<q>(at.z));
  if (constants.with_border) texel = mix(constants.border, texel, hn::Broadcast<q>(at.border_weight));

  Floats colour = hn::Mul(constants.map_columns[0], hn::Broadcast<0>(texel));
  colour = hn::MulAdd(constants.map_columns[1], hn::Broadcast<1>(texel), colour);
  colour = hn::MulAdd(constants.map_columns[2], hn::Broadcast<2>(texel), colour);
  colour = hn::MulAdd(constants.map_columns[3], hn::Broadcast<3>(texel), colour);
  const Floats one = hn::Set(f, 1.0F);
  colour = hn::Min(hn::Max(colour, hn::Zero(f)), one);
  const Floats alpha = hn::Broadcast<3>(colour);
  // Multiplies by alpha if the map requires it.
  const Floats otherwise = hn::Sub(one, constants.scaled_by_alpha);
  const Floats premultiplied = hn::Mul(colour, hn::MulAdd(alpha, constants.scaled_by_alpha, otherwise));
  const auto shown =
      hn::And(hn::Gt(alpha, constants.alpha_above), hn::Gt(hn::Broadcast<q>(present), hn::Zero(f)));
  return hn::IfThenElse(shown, premultiplied, constants.neutral);
}

HWY_INLINE void classify(const Located& at, const Packet& rays, const Constants& constants, Colours8,
                         Colours& out) {
  const FloatTag f;
  const Corners corners = corners_of<4>(at, constants);
  const Floats present = hn::IfThenElseZero(hn::Le(rays.k, rays.last), hn::Set(f, 1.0F));
  out[0] = colour_of_column<0>(corners, at, present, constants);
  out[1] = colour_of_column<1>(corners, at, present, constants);
  out[2] = colour_of_column<2>(corners, at, present, constants);
  out[3] = colour_of_column<3>(corners, at, present, constants);
}

/// Interpolates rows of eight floats of a table at the positions of column q's rays.
template <std::size_t q>
HWY_INLINE Floats interpolated_row(const TablePlace& at, const float* table) {
  const FloatTag f;
  std::array<const float*, lanes> entries;
#pragma GCC unroll 4
  for (std::size_t row = 0; row < rows; ++row) entries[q + 4 * row] = table + at.entry[q + 4 * row];
  const Floats entry = load_column<q>(f, entries.data(), 0), slope = load_column<q>(f, entries.data(), 4);
  return hn::MulAdd(slope, hn::Broadcast<q>(at.between), entry);
}

template <std::size_t q>
HWY_INLINE Floats colour_at(const TablePlace& at, const Constants& constants) {
  return interpolated_row<q>(at, constants.entries);
}

template <std::size_t q>
HWY_INLINE Floats colour_at(const Colours& at, const Constants&) {
  return at[q];
}

/// Composites under `over`; a pixel whose opacity has reached the limit stays unchanged.
HWY_INLINE Floats composed_to_limit(Floats pixel, Floats colour, Floats limit) {
  const Floats alpha = hn::Broadcast<3>(pixel);
  const Floats room = hn::IfThenElseZero(hn::Lt(alpha, limit), hn::Sub(hn::Set(FloatTag(), 1.0F), alpha));
  return hn::MulAdd(room, colour, pixel);
}

template <Operator op>
HWY_INLINE Floats composed(Floats pixel, Floats colour) {
  if constexpr (op == Operator::over) {
    // Accumulates opacity, not transparency: thin fog must not be lost by rounding next to 1.
    const Floats room = hn::Sub(hn::Set(FloatTag(), 1.0F), hn::Broadcast<3>(pixel));
    return hn::MulAdd(room, colour, pixel);
  } else if constexpr (op == Operator::add) {
    return hn::Add(pixel, colour);
  } else if constexpr (op == Operator::first_hit) {
    const FloatTag f;
    const Floats zero = hn::Zero(f), alpha = hn::Broadcast<3>(colour);
    const auto hit = hn::And(hn::Gt(alpha, zero), hn::Eq(hn::Broadcast<3>(pixel), zero));
    if (hn::AllFalse(f, hit)) return pixel;
    const Floats largest = hn::Set(f, std::numeric_limits<float>::max());
    const Floats plain = hn::Div(colour, hn::IfThenElse(hit, alpha, largest));
    return hn::IfThenElse(hit, hn::Min(hn::Max(plain, hn::Neg(largest)), largest), pixel);
  } else if constexpr (op == Operator::max) {
    return hn::Max(pixel, colour);
  } else {
    return hn::Min(pixel, colour);
  }
}

/// Alpha of every ray, from the blending layout to one lane per ray.
HWY_INLINE Floats alphas(const std::array<Floats, 4>& pixels) {
  const FloatTag f;
  const hn::Repartition<double, FloatTag> wide;
  const auto pair01 = hn::BitCast(wide, hn::InterleaveUpper(f, pixels[0], pixels[1]));
  const auto pair23 = hn::BitCast(wide, hn::InterleaveUpper(f, pixels[2], pixels[3]));
  return hn::BitCast(f, hn::InterleaveUpper(wide, pair01, pair23));
}
