// SPDX-License-Identifier: Apache-2.0
// Shared by the vector kernels: packets of rays, the field at their positions, and colours. A part of
// vector_kernel.cc and vector_segments-inl.h, included there once per instruction set.
//
// A packet is 4 rays wide and one row high per 128 bits of the vector; lane q + 4 g is the ray in column q, row
// g.
//
// The corners of a cell lie close together in its block, so that no gather is needed: for bytes, two loads of
// 16 bytes, a shuffle and one 16-bit multiply-add interpolate four edges along x, with weights of 15 bits.
// Colours are blended ray by ray, components side by side: a table entry is one load.

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using ByteTag = hn::Repartition<std::uint8_t, FloatTag>;
using ShortTag = hn::Repartition<std::int16_t, FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;
using Bytes = hn::Vec<ByteTag>;

constexpr std::size_t lanes = HWY_MAX_BYTES / sizeof(float);
constexpr std::size_t rows = lanes / 4;
static_assert(packet_height % rows == 0 && tile_width % 4 == 0);

/// Loads 128 bits from each of the addresses from[q], from[q + 4], ..., plus `offset` elements.
template <std::size_t q, class D, typename T = hn::TFromD<D>>
HWY_INLINE hn::Vec<D> load_column(D d, const T* const* from, std::size_t offset) {
  if constexpr (rows == 1) {
    return hn::LoadU(d, from[q] + offset);
  } else {
    const hn::Half<D> half;
    if constexpr (rows == 2) {
      return hn::Combine(d, hn::LoadU(half, from[q + 4] + offset), hn::LoadU(half, from[q] + offset));
    } else {
      const hn::Half<decltype(half)> quarter;
      const auto low =
          hn::Combine(half, hn::LoadU(quarter, from[q + 4] + offset), hn::LoadU(quarter, from[q] + offset));
      const auto high = hn::Combine(half, hn::LoadU(quarter, from[q + 12] + offset),
                                    hn::LoadU(quarter, from[q + 8] + offset));
      return hn::Combine(d, high, low);
    }
  }
}

/// The sums of neighbouring products of 16-bit integers.
HWY_INLINE Ints pairwise_products(Ints a, Ints b) {
  const ShortTag s;
  Ints unused = hn::Zero(IntTag());
  return hn::ReorderWidenMulAccumulate(IntTag(), hn::BitCast(s, a), hn::BitCast(s, b), hn::Zero(IntTag()),
                                       unused);
}

/// Transposes four vectors with one 128-bit block per ray and one edge per lane into four vectors of one edge
/// each, with one ray per lane.
HWY_INLINE void transpose(std::array<Floats, 4>& v) {
  const FloatTag narrow;
  const hn::Repartition<double, FloatTag> wide;
  const auto a = hn::BitCast(wide, hn::InterleaveLower(narrow, v[0], v[1]));
  const auto b = hn::BitCast(wide, hn::InterleaveUpper(narrow, v[0], v[1]));
  const auto c = hn::BitCast(wide, hn::InterleaveLower(narrow, v[2], v[3]));
  const auto d = hn::BitCast(wide, hn::InterleaveUpper(narrow, v[2], v[3]));
  v[0] = hn::BitCast(narrow, hn::InterleaveLower(wide, a, c));
  v[1] = hn::BitCast(narrow, hn::InterleaveUpper(wide, a, c));
  v[2] = hn::BitCast(narrow, hn::InterleaveLower(wide, b, d));
  v[3] = hn::BitCast(narrow, hn::InterleaveUpper(wide, b, d));
}

HWY_INLINE Floats mix(Floats a, Floats b, Floats s) {
  return hn::MulAdd(s, hn::Sub(b, a), a);
}

/// Truncates values that are known to fit, without ConvertTo's handling of others.
HWY_INLINE Ints truncated(Floats v) {
#if HWY_TARGET <= HWY_AVX3
  return Ints{_mm512_cvttps_epi32(v.raw)};
#elif HWY_TARGET <= HWY_AVX2
  return Ints{_mm256_cvttps_epi32(v.raw)};
#else
  return Ints{_mm_cvttps_epi32(v.raw)};
#endif
}

/// The sum of all lanes.
HWY_INLINE std::uint64_t total(Ints counts) {
  alignas(64) std::array<std::int32_t, lanes> by_lane;
  hn::Store(counts, IntTag(), by_lane.data());
  std::uint64_t sum = 0;
  for (const std::int32_t count : by_lane) sum += std::uint64_t(count);
  return sum;
}

/// Texels as the kernel reads them. Interpolation along x in 16-bit integers uses the weights -2^15 (1 - s) and
/// -2^15 s, because -2^15 is representable (+2^15 is not), and a power of two keeps texel values exact.
/// `factor` and `zero` relate the results to texel values: result = factor * (value - zero).
struct Bytes8 {
  static constexpr bool scalar = true;
  static constexpr std::size_t bytes = 1;
  static constexpr float factor = -32768, zero = 0;
};
/// The same under Filter::linear_8_bit, whose samples are integers.
struct RoundedBytes8 {
  static constexpr bool scalar = true;
  static constexpr float factor = 1, zero = 0;
};
struct Shorts16 {
  static constexpr bool scalar = true;
  static constexpr std::size_t bytes = 2;
  static constexpr float factor = -32768, zero = 32768;  // made signed
};
struct Floats32 {
  static constexpr bool scalar = true;
  static constexpr std::size_t bytes = 4;
  static constexpr float factor = 1, zero = 0;
};
struct Colours8 {
  static constexpr bool scalar = false;
  static constexpr float factor = -32768, zero = 0;
};

/// Constants of a frame, as vectors.
struct Constants {
  template <typename Source>
  Constants(const Scene& scene, Source)
      : blocks(scene.store->block_data().data()),
        distances(reinterpret_cast<const std::int32_t*>(scene.skip->distances())),
        bounds(scene.bounds),
        skips(scene.skip->empty_bricks() > 0),
        nearest(scene.filter == Filter::nearest),
        with_border(scene.has_border[0] || scene.has_border[1] || scene.has_border[2]),
        op(scene.op) {
    const FloatTag f;
    const IntTag d;
    const auto& counts = scene.store->block_counts();
    const auto& first = scene.store->first_block();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      top[axis] = hn::Set(f, scene.top[axis]);
      rounding[axis] = hn::Set(f, scene.rounding[axis] / BrickStore::block_cells);
      border_weight[axis] = hn::Set(f, scene.has_border[axis] ? 1.0F : 0.0F);
    }
    blocks_x = hn::Set(d, counts[0]);
    blocks_y = hn::Set(d, counts[1]);
    // Sums of the lattice's block indices may wrap around; their difference to this is small and correct again.
    const auto wide = [](int v) { return std::uint32_t(v); };
    first_block = hn::Set(
        d,
        std::int32_t((wide(first[2]) * wide(counts[1]) + wide(first[1])) * wide(counts[0]) + wide(first[0])));
    neutral = hn::Set(f, neutral_value(scene.op));
    is_limited = scene.op == Operator::over && scene.opacity_limit < 1;
    opacity_limit = hn::Set(f, scene.opacity_limit);
    // A first hit is opaque.
    termination = hn::Set(f, scene.op == Operator::over        ? scene.termination
                             : scene.op == Operator::first_hit ? 0.5F
                                                               : -std::numeric_limits<float>::infinity());

    Rgba border_texel = scene.store->border();
    for (float& v : border_texel) v = Source::factor * (v - Source::zero);
    if (scene.fog != nullptr) {
      fog_rows = scene.fog->rows();
      for (std::size_t axis = 0; axis < 3; ++axis) fog_gradient[axis] = hn::Set(f, scene.fog->gradient()[axis]);
      fog_offset = hn::Set(f, scene.fog->offset());
      fog_last = hn::Set(f, scene.fog->last());
    }
    alignas(16) static constexpr float colour_lanes[4] = {1, 1, 1, 0};
    if constexpr (Source::scalar) {
      const auto take = [&](const auto& table) {
        table_low = hn::Set(f, Source::factor * (table.low() - Source::zero));
        table_scale = hn::Set(f, table.scale() / Source::factor);
        table_last = hn::Set(f, table.last());
      };
      border = hn::Set(f, border_texel[0]);
      if (scene.pairs != nullptr) {
        const PreIntegrationLookup& pairs = *scene.pairs;
        take(pairs);
        entries = pairs.entries();
        neutral_entry = hn::Set(d, std::int32_t(pairs.neutral_entry()));
        pair_row = std::size_t(pairs.edge());
        last_corner = hn::Set(d, pairs.edge() - 2);
        scaled_by_alpha = pairs.multiply_by_alpha() ? hn::LoadDup128(f, colour_lanes) : hn::Zero(f);
        samples_on = hn::Set(f, scene.samples_on);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          cells_away[axis] = hn::Set(f, scene.cells_away[axis]);
          held_low[axis] = hn::Set(f, scene.held_low[axis]);
          held_high[axis] = hn::Set(f, scene.held_high[axis]);
        }
      } else {
        take(*scene.table);
        entries = scene.table->rows();
        neutral_entry = hn::Set(d, std::int32_t(scene.table->entries()));
      }
    } else {
      const LinearMap& map = *scene.map;
      for (std::size_t k = 0; k < 4; ++k) {
        alignas(16) float column[4];
        for (std::size_t row = 0; row < 4; ++row)
          column[row] = map.matrix[4 * row + k] / (255 * Source::factor);
        map_columns[k] = hn::LoadDup128(f, column);
      }
      scaled_by_alpha = map.multiply_by_alpha ? hn::LoadDup128(f, colour_lanes) : hn::Zero(f);
      alpha_above = hn::Set(f, map.alpha_above);
      border = hn::LoadDup128(f, border_texel.data());
    }
  }

  const std::byte* const* blocks;
  const std::int32_t* distances;  // a byte each; gathered four at a time
  const float* bounds;            // upper bounds of blocks, under a maximum; may be null
  bool skips, nearest, with_border;
  bool is_limited = false;  // opacity_limit applies
  Operator op;
  std::array<Floats, 3> top, border_weight;
  std::array<Floats, 3> rounding;  // in blocks
  Ints blocks_x, blocks_y, first_block;
  Floats neutral, termination, opacity_limit, border;

  const float* entries = nullptr;  // of the transfer function, or of the pre-integration table
  Floats table_low, table_scale, table_last;
  Ints neutral_entry;

  std::size_t pair_row = 0;  // entries per row of the pre-integration table
  Ints last_corner;
  Floats samples_on;
  std::array<Floats, 3> cells_away, held_low, held_high;

  std::array<Floats, 4> map_columns;  // of the linear map of colours; components side by side
  Floats scaled_by_alpha;             // of colours and pairs: 1 for components that alpha multiplies, else 0
  Floats alpha_above;

  const float* fog_rows = nullptr;  // null: no fog
  std::array<Floats, 3> fog_gradient;
  Floats fog_offset, fog_last;
};

/// A packet's rays, and the index of the next sample of each (an integer).
struct Packet {
  std::array<Floats, 3> start, step;
  Floats k, last;
  std::array<Floats, 3> steps_per_block,
      direction;  // for skipping: steps per block, slightly reduced, and the sign of `step`

  bool done() const { return hn::AllTrue(FloatTag(), hn::Gt(k, last)); }
};

/// Adjacent packets that skip together, so that their independent instruction chains overlap.
constexpr std::size_t group = 2;
static_assert(tile_width % (4 * group) == 0);
using Group = std::array<Packet, group>;

/// Sample positions. As everywhere, each product and each sum is rounded separately.
struct Position {
  std::array<Floats, 3> free, clamped;
};

HWY_INLINE Position position_of(const Packet& rays, const Constants& constants) {
  // Finished rays stay at the last sample, where it is safe to read.
  const Floats k = hn::Min(rays.k, rays.last);
  Position p;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    p.free[axis] = hn::Add(hn::Mul(k, rays.step[axis]), rays.start[axis]);
    p.clamped[axis] = hn::Min(hn::Max(p.free[axis], hn::Zero(FloatTag())), constants.top[axis]);
  }
  return p;
}

/// Index among the blocks held, from block coordinates in the lattice.
HWY_INLINE Ints block_index(Ints x, Ints y, Ints z, const Constants& constants) {
  const Ints row = hn::Add(hn::Mul(z, constants.blocks_y), y);
  return hn::Add(hn::Mul(row, constants.blocks_x), hn::Sub(x, constants.first_block));
}

/// Advances the rays that are in an empty block and, with `bounded`, those in a block that can show no more
/// than `shown`. Returns false if there were none.
template <bool bounded>
HWY_INLINE bool skip(Packet& rays, const Constants& constants, Floats shown) {
  const FloatTag f;
  const IntTag d;
  const Floats half = hn::Set(f, 0.5F);
  const Position p = position_of(rays, constants);
  std::array<Ints, 3> block;
  std::array<Floats, 3> steps_to_face;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Floats blocks = hn::Mul(p.clamped[axis], hn::Set(f, 1.0F / BrickStore::block_cells));
    block[axis] = truncated(blocks);
    // Steps to the face ahead, less one block; rounding must not lead past it.
    const Floats in_block = hn::Sub(hn::Sub(blocks, hn::ConvertTo(f, block[axis])), half);
    const Floats room = hn::Sub(hn::NegMulSub(rays.direction[axis], in_block, half), constants.rounding[axis]);
    steps_to_face[axis] = hn::Mul(room, rays.steps_per_block[axis]);
  }
  const Ints index = block_index(block[0], block[1], block[2], constants);
  Floats distance = hn::ConvertTo(f, hn::And(hn::GatherOffset(d, constants.distances, index), hn::Set(d, 255)));
  if constexpr (bounded) {
    const auto exhausted = hn::Le(hn::GatherIndex(f, constants.bounds, index), shown);
    distance = hn::Max(distance, hn::IfThenElseZero(exhausted, hn::Set(f, 1.0F)));
  }
  const auto empty = hn::And(hn::Gt(distance, hn::Zero(f)), hn::Le(rays.k, rays.last));
  // All blocks fewer than `distance` blocks away are empty.
  Floats steps = hn::Set(f, 1e9F);
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    steps = hn::Min(steps, hn::MulAdd(distance, rays.steps_per_block[axis], steps_to_face[axis]));
  const Floats whole = hn::Add(hn::Floor(hn::Max(steps, hn::Zero(f))), hn::Set(f, 1.0F));
  rays.k = hn::Add(rays.k, hn::IfThenElseZero(empty, whole));
  return !hn::AllFalse(f, empty);
}

/// Advances every ray out of empty bricks, to its next sample in a block that shows something or past its last
/// sample.
HWY_INLINE void skip_empty(Group& packets, const Constants& constants) {
  for (bool again = true; again;) {
    again = false;
#pragma GCC unroll 2
    for (Packet& rays : packets) again |= skip<false>(rays, constants, hn::Zero(FloatTag()));
  }
}

/// The same under a maximum with bounds of blocks; `shown` is the maximum of each ray so far.
HWY_INLINE void skip_exhausted(Group& packets, const std::array<Floats, group>& shown,
                               const Constants& constants) {
  for (bool again = true; again;) {
    again = false;
#pragma GCC unroll 2
    for (std::size_t g = 0; g < group; ++g) again |= skip<true>(packets[g], constants, shown[g]);
  }
}

/// One sample of every ray, as passed between the three passes of take_samples().
struct Located {
  alignas(64) std::array<std::uint32_t, lanes> block, corner;  // of the cell's texels
  Ints weights;                                                // along x, for pairs of 16-bit texels
  Floats x, y, z, border_weight;
};

HWY_INLINE void locate(const Position& p, const Constants& constants, Located& out) {
  const FloatTag f;
  const IntTag d;
  const hn::RebindToUnsigned<IntTag> u;
  std::array<Ints, 3> cell;
  std::array<Floats, 3> fraction;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = truncated(p.clamped[axis]);
    fraction[axis] = hn::Sub(p.clamped[axis], hn::ConvertTo(f, cell[axis]));
  }
  const Floats one = hn::Set(f, 1.0F);
  if (constants.nearest)
    for (Floats& s : fraction) s = hn::IfThenElseZero(hn::Ge(s, hn::Set(f, 0.5F)), one);

  const Ints block = block_index(hn::ShiftRight<3>(cell[0]), hn::ShiftRight<3>(cell[1]),
                                 hn::ShiftRight<3>(cell[2]), constants);
  const Ints seven = hn::Set(d, BrickStore::block_cells - 1);
  const Ints yz = hn::Or(hn::And(cell[1], seven), hn::ShiftLeft<16>(hn::And(cell[2], seven)));
  const Ints strides = hn::Set(d, BrickStore::block_row | BrickStore::block_slice << 16);
  const Ints corner = hn::Add(hn::And(cell[0], seven), pairwise_products(yz, strides));
  hn::Store(hn::BitCast(u, block), u, out.block.data());
  hn::Store(hn::BitCast(u, corner), u, out.corner.data());

  const Ints high = truncated(hn::MulAdd(fraction[0], hn::Set(f, 32768.0F), hn::Set(f, 0.5F)));
  out.weights = hn::Sub(hn::Xor(high, hn::Set(d, 0x8000)), hn::ShiftLeft<16>(high));
  out.x = fraction[0];
  out.y = fraction[1];
  out.z = fraction[2];

  if (constants.with_border) {
    // Beyond the outermost texel centres the filter blends in a constant, one axis at a time, so the weights
    // multiply.
    out.border_weight = one;
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Floats beyond = hn::Min(hn::Abs(hn::Sub(p.free[axis], p.clamped[axis])), one);
      out.border_weight = hn::Mul(out.border_weight, hn::NegMulAdd(beyond, constants.border_weight[axis], one));
    }
  }
}

/// The first texel of each ray's cell.
using Corners = std::array<const std::uint8_t*, lanes>;

template <std::size_t bytes_per_texel>
HWY_INLINE Corners corners_of(const Located& at, const Constants& constants) {
  Corners corners;
#pragma GCC unroll 16
  for (std::size_t lane = 0; lane < lanes; ++lane)
    corners[lane] = reinterpret_cast<const std::uint8_t*>(constants.blocks[at.block[lane]]) +
                    at.corner[lane] * bytes_per_texel;
  return corners;
}

/// Four edges along x: y and z low, y high, z high, both high.
constexpr std::array<std::size_t, 4> edge_offsets{0, BrickStore::block_row, BrickStore::block_slice,
                                                  BrickStore::block_slice + BrickStore::block_row};

/// The texels at the ends of column q's four edges, as 16-bit integers: one 128-bit block per ray.
template <std::size_t q>
HWY_INLINE Bytes edge_texels(const Corners& corners) {
  const ByteTag d;
  // Bytes 0, 1 (the corner's row) and 9, 10 (the next row), widened to 16 bits: lower slice first, then the
  // upper.
  alignas(16) static constexpr std::uint8_t lower[16] = {0,   128, 1,   128, 9,   128, 10,  128,
                                                         128, 128, 128, 128, 128, 128, 128, 128};
  alignas(16) static constexpr std::uint8_t upper[16] = {128, 128, 128, 128, 128, 128, 128, 128,
                                                         0,   128, 1,   128, 9,   128, 10,  128};
  static_assert(BrickStore::block_row == 9);
  const Bytes near = load_column<q>(d, corners.data(), 0);
  const Bytes far = load_column<q>(d, corners.data(), BrickStore::block_slice);
  return hn::Or(hn::TableLookupBytesOr0(near, hn::LoadDup128(d, lower)),
                hn::TableLookupBytesOr0(far, hn::LoadDup128(d, upper)));
}

/// The four edges of column q's cells, interpolated along x: one 128-bit block per ray.
template <std::size_t q>
HWY_INLINE Floats edges_of_column(const Corners& corners, const Located& at, const Constants&, Bytes8) {
  const Ints texels = hn::BitCast(IntTag(), edge_texels<q>(corners));
  return hn::ConvertTo(FloatTag(), pairwise_products(texels, hn::Broadcast<q>(at.weights)));
}

template <std::size_t q>
HWY_INLINE Floats edges_of_column(const Corners& corners, const Located& at, const Constants&, Shorts16) {
  const IntTag d;
  const hn::Repartition<std::int64_t, FloatTag> wide;
  const auto pair = [&](std::size_t edge) HWY_ATTR {
    return hn::BitCast(d, load_column<q>(ByteTag(), corners.data(), 2 * edge_offsets[edge]));
  };
  const Ints near = hn::InterleaveLower(d, pair(0), pair(1)), far = hn::InterleaveLower(d, pair(2), pair(3));
  const Ints all = hn::BitCast(d, hn::InterleaveLower(wide, hn::BitCast(wide, near), hn::BitCast(wide, far)));
  const Ints made_signed = hn::Xor(all, hn::Set(d, std::int32_t(0x80008000)));
  return hn::ConvertTo(FloatTag(), pairwise_products(made_signed, hn::Broadcast<q>(at.weights)));
}

/// The nearest filter selects one value: multiplied by a weight of 0, a neighbour's NaN would remain NaN.
HWY_INLINE Floats mix_or_choose(Floats a, Floats b, Floats s, bool nearest) {
  return nearest ? hn::IfThenElse(hn::Gt(s, hn::Zero(FloatTag())), b, a) : mix(a, b, s);
}

template <std::size_t q>
HWY_INLINE Floats edges_of_column(const Corners& corners, const Located& at, const Constants& constants,
                                  Floats32) {
  const FloatTag f;
  const hn::Repartition<double, FloatTag> wide;
  const auto pair = [&](std::size_t edge) HWY_ATTR {
    return hn::BitCast(f, load_column<q>(ByteTag(), corners.data(), 4 * edge_offsets[edge]));
  };
  const auto near = hn::BitCast(wide, hn::InterleaveLower(f, pair(0), pair(1)));
  const auto far = hn::BitCast(wide, hn::InterleaveLower(f, pair(2), pair(3)));
  const Floats low = hn::BitCast(f, hn::InterleaveLower(wide, near, far));
  const Floats high = hn::BitCast(f, hn::InterleaveUpper(wide, near, far));
  return mix_or_choose(low, high, hn::Broadcast<q>(at.x), constants.nearest);
}

template <typename Source>
HWY_INLINE Floats field_at(const Located& at, const Constants& constants, Source source) {
  const Corners corners = corners_of<Source::bytes>(at, constants);
  std::array<Floats, 4> edges{
      edges_of_column<0>(corners, at, constants, source), edges_of_column<1>(corners, at, constants, source),
      edges_of_column<2>(corners, at, constants, source), edges_of_column<3>(corners, at, constants, source)};
  transpose(edges);
  const bool choose = std::is_same_v<Source, Floats32> && constants.nearest;
  return mix_or_choose(mix_or_choose(edges[0], edges[1], at.y, choose),
                       mix_or_choose(edges[2], edges[3], at.y, choose), at.z, choose);
}

/// Weights (filter_steps - s, s) for pairs of 16-bit values, from interpolation fractions.
HWY_INLINE Ints rounded_weights(Floats fraction) {
  const Ints high = hn::NearestInt(hn::Mul(fraction, hn::Set(FloatTag(), float(filter_steps))));
  return hn::Add(hn::Set(IntTag(), filter_steps), hn::Sub(hn::ShiftLeft<16>(high), high));
}

/// rounded_mix() of pairs of 16-bit values.
HWY_INLINE Ints rounded_mix_of(Ints pairs, Ints weights) {
  const Ints half = hn::Set(IntTag(), filter_steps / 2);
  return hn::ShiftRight<8>(hn::Add(pairwise_products(pairs, weights), half));
}
static_assert(filter_steps == 1 << 8);

template <std::size_t q>
HWY_INLINE Floats rounded_edges_of_column(const Corners& corners, Ints weights) {
  const Ints texels = hn::BitCast(IntTag(), edge_texels<q>(corners));
  return hn::BitCast(FloatTag(), rounded_mix_of(texels, hn::Broadcast<q>(weights)));
}

HWY_INLINE Floats field_at(const Located& at, const Constants& constants, RoundedBytes8) {
  const FloatTag f;
  const IntTag d;
  const Corners corners = corners_of<1>(at, constants);
  const Ints x = rounded_weights(at.x), y = rounded_weights(at.y), z = rounded_weights(at.z);
  std::array<Floats, 4> edges{rounded_edges_of_column<0>(corners, x), rounded_edges_of_column<1>(corners, x),
                              rounded_edges_of_column<2>(corners, x), rounded_edges_of_column<3>(corners, x)};
  transpose(edges);
  const auto pairs = [&](Ints low, Ints high) HWY_ATTR { return hn::Or(low, hn::ShiftLeft<16>(high)); };
  const auto edge = [&](std::size_t i) HWY_ATTR { return hn::BitCast(d, edges[i]); };
  const Ints near = rounded_mix_of(pairs(edge(0), edge(1)), y);
  const Ints far = rounded_mix_of(pairs(edge(2), edge(3)), y);
  return hn::ConvertTo(f, rounded_mix_of(pairs(near, far), z));
}

#include "volume/raycast/vector_colour-inl.h"

/// Loads one value per lane: those of the rays whose lower left one is ray (x, y) of the packet.
template <typename Values>
HWY_INLINE Floats values_of_rays(const Values& of_packet, std::size_t x, std::size_t y) {
  alignas(64) float packed[lanes];
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t q = 0; q < 4; ++q) packed[4 * row + q] = float(of_packet[(y + row) * tile_width + x + q]);
  return hn::Load(FloatTag(), packed);
}

HWY_INLINE Packet packet_of(const RayPacket& packet, std::size_t x, std::size_t y) {
  const FloatTag f;
  const auto load = [&](const auto& values) HWY_ATTR { return values_of_rays(values, x, y); };
  constexpr float block_cells = BrickStore::block_cells;
  Packet rays;
  rays.k = load(packet.first);
  rays.last = load(packet.last);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rays.start[axis] = load(packet.start[axis]);
    rays.step[axis] = load(packet.step[axis]);
    rays.direction[axis] = hn::CopySign(hn::Set(f, 1.0F), rays.step[axis]);
    const Floats speed = hn::Max(hn::Abs(rays.step[axis]), hn::Set(f, 1e-20F));
    rays.steps_per_block[axis] = hn::Div(hn::Set(f, block_cells * (1 - 1e-6F)), speed);
  }
  return rays;
}
