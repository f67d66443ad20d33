// The common case fast: bytes, `over`, linear or nearest filter, on the vector instructions of the machine it
// runs on.
//
// A packet is 4 rays wide and one row high per 128 bits of the vector; lane q + 4 g is the ray in column q, row
// g.
//  - The eight corners of a cell lie in two pieces of 16 bytes of its block: two loads, a byte shuffle and one
//  16-bit
//    multiply-add interpolate four edges along x, with weights of 15 bits; y and z follow in float. No gather.
//  - Table entries are loaded as RGBA and blended ray by ray, four rays' components side by side.
//  - Early termination and empty blocks are looked at once per eight samples, so that addresses never wait for
//  colours.
#include <algorithm>
#include <array>

#include "volume/raycast/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/raycast/u8_kernel.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::volume {
namespace HWY_NAMESPACE {

// The multiply-add below must sum neighbouring products, which Highway leaves open; so x86 alone takes this
// path.
#if HWY_TARGET == HWY_SSSE3 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || \
    HWY_TARGET == HWY_AVX3_DL

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
static_assert(strip_height % rows == 0 && tile_width % 4 == 0);

/// 128 bits from each of the addresses from[q], from[q + 4], ..., `offset` elements on.
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

struct Edges {
  Floats low_y_low_z, high_y_low_z, low_y_high_z, high_y_high_z;
};

/// The four edges along x of column q's cells, times -2^15: one 128-bit block per ray.
template <std::size_t q>
HWY_INLINE Ints edges_of_column(const std::uint8_t* const* corners, Ints weights) {
  const ByteTag d;
  // Bytes 0, 1 (the corner's row) and 9, 10 (the next row), widened to 16 bits: lower slice first, upper slice
  // second.
  alignas(16) static constexpr std::uint8_t lower[16] = {0,   128, 1,   128, 9,   128, 10,  128,
                                                         128, 128, 128, 128, 128, 128, 128, 128};
  alignas(16) static constexpr std::uint8_t upper[16] = {128, 128, 128, 128, 128, 128, 128, 128,
                                                         0,   128, 1,   128, 9,   128, 10,  128};
  static_assert(BrickStore::block_row == 9);
  const Bytes near = load_column<q>(d, corners, 0), far = load_column<q>(d, corners, BrickStore::block_slice);
  const Bytes eight = hn::Or(hn::TableLookupBytesOr0(near, hn::LoadDup128(d, lower)),
                             hn::TableLookupBytesOr0(far, hn::LoadDup128(d, upper)));
  Ints unused = hn::Zero(IntTag());
  return hn::ReorderWidenMulAccumulate(IntTag(), hn::BitCast(ShortTag(), eight),
                                       hn::BitCast(ShortTag(), hn::Broadcast<q>(weights)), hn::Zero(IntTag()),
                                       unused);
}

/// Four vectors of one ray per block become four vectors of one edge each.
HWY_INLINE Edges transposed(Ints e0, Ints e1, Ints e2, Ints e3) {
  const FloatTag f;
  const hn::Repartition<std::int64_t, FloatTag> wide;
  const IntTag narrow;
  const auto a = hn::BitCast(wide, hn::InterleaveLower(narrow, e0, e1)),
             b = hn::BitCast(wide, hn::InterleaveUpper(narrow, e0, e1)),
             c = hn::BitCast(wide, hn::InterleaveLower(narrow, e2, e3)),
             d = hn::BitCast(wide, hn::InterleaveUpper(narrow, e2, e3));
  return {hn::ConvertTo(f, hn::BitCast(narrow, hn::InterleaveLower(wide, a, c))),
          hn::ConvertTo(f, hn::BitCast(narrow, hn::InterleaveUpper(wide, a, c))),
          hn::ConvertTo(f, hn::BitCast(narrow, hn::InterleaveLower(wide, b, d))),
          hn::ConvertTo(f, hn::BitCast(narrow, hn::InterleaveUpper(wide, b, d)))};
}

HWY_INLINE Floats mix(Floats a, Floats b, Floats s) {
  return hn::MulAdd(s, hn::Sub(b, a), a);
}

/// Composites one table entry per ray of column q: pixel += (1 - alpha) (entry + fraction * slope).
template <std::size_t q>
HWY_INLINE Floats composed(Floats pixel, const float* const* entries, Floats fraction) {
  const FloatTag f;
  const Floats colour =
      hn::MulAdd(load_column<q>(f, entries, 4), hn::Broadcast<q>(fraction), load_column<q>(f, entries, 0));
  const Floats room = hn::Sub(hn::Set(f, 1.0F), hn::Broadcast<3>(pixel));
  return hn::MulAdd(room, colour, pixel);
}

/// Truncation of values that are known to fit, without the care for others that ConvertTo takes.
HWY_INLINE Ints truncated(Floats v) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return Ints{_mm512_cvttps_epi32(v.raw)};
#elif HWY_TARGET == HWY_AVX2
  return Ints{_mm256_cvttps_epi32(v.raw)};
#else
  return Ints{_mm_cvttps_epi32(v.raw)};
#endif
}

/// What stays the same for all samples of a frame, in vectors.
struct Constants {
  explicit Constants(const Scene& scene)
      : blocks(scene.store->block_data().data()),
        distances(reinterpret_cast<const std::int32_t*>(scene.skip->distances())),
        entries(scene.table->rows()) {
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
    first_block = hn::Set(d, (first[2] * counts[1] + first[1]) * counts[0] + first[0]);
    const TransferTable& table = *scene.table;
    table_scale = hn::Set(f, table.scale() / -32768.0F);
    table_offset = hn::Set(f, -table.low() * table.scale());
    table_last = hn::Set(f, table.last());
    clear_entry = hn::Set(d, std::int32_t(table.entries()));
    border = hn::Set(f, -32768.0F * scene.store->border()[0]);
  }

  const std::byte* const* blocks;
  const std::int32_t* distances;  // a byte each; four are gathered
  const float* entries;
  std::array<Floats, 3> top, border_weight;
  std::array<Floats, 3> rounding;  // in blocks
  Ints blocks_x, blocks_y, first_block, clear_entry;
  Floats table_scale, table_offset, table_last, border;
};

/// A packet's rays, and the next sample of each (a whole number).
struct Packet {
  std::array<Floats, 3> start, step;
  Floats k, last;
  std::array<Floats, 3> steps_per_block,
      direction;  // for leaps: a little too few steps, and the sign of `step`

  bool done() const { return hn::AllTrue(FloatTag(), hn::Gt(k, last)); }
};

/// Packets side by side that leap together, so that one's chain of instructions fills the gaps of the other's.
constexpr std::size_t group = 2;
static_assert(tile_width % (4 * group) == 0);
using Group = std::array<Packet, group>;

/// Sample positions, each product and sum rounded by itself as everywhere.
struct Position {
  std::array<Floats, 3> free, clamped;
};

HWY_INLINE Position position_of(const Packet& rays, const Constants& constants) {
  // Rays at their end stay on the last sample, where it is safe to read.
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

/// Lets the rays that are in an empty block leap; false when there were none.
HWY_INLINE bool leap(Packet& rays, const Constants& constants) {
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
    // Steps to the face ahead, less one block; rounding must not carry us past it.
    const Floats in_block = hn::Sub(hn::Sub(blocks, hn::ConvertTo(f, block[axis])), half);
    const Floats room = hn::Sub(hn::NegMulSub(rays.direction[axis], in_block, half), constants.rounding[axis]);
    steps_to_face[axis] = hn::Mul(room, rays.steps_per_block[axis]);
  }
  const Ints index = block_index(block[0], block[1], block[2], constants);
  const Floats distance =
      hn::ConvertTo(f, hn::And(hn::GatherOffset(d, constants.distances, index), hn::Set(d, 255)));
  const auto empty = hn::And(hn::Gt(distance, hn::Zero(f)), hn::Le(rays.k, rays.last));
  // All blocks fewer than `distance` steps away are empty.
  Floats steps = hn::Set(f, 1e9F);
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    steps = hn::Min(steps, hn::MulAdd(distance, rays.steps_per_block[axis], steps_to_face[axis]));
  const Floats whole = hn::Add(hn::Floor(hn::Max(steps, hn::Zero(f))), hn::Set(f, 1.0F));
  rays.k = hn::Add(rays.k, hn::IfThenElseZero(empty, whole));
  return !hn::AllFalse(f, empty);
}

/// Moves every ray out of empty blocks, to its next sample in a block that shows something or past its last
/// sample.
HWY_INLINE void skip_empty(Group& packets, const Constants& constants) {
  for (bool again = true; again;) {
    again = false;
#pragma GCC unroll 2
    for (Packet& rays : packets) again |= leap(rays, constants);
  }
}

/// One sample of every ray on its way through the three passes.
struct Located {
  alignas(64) std::array<std::uint32_t, lanes> block, corner;  // where the cell's texels are
  Ints weights;                                                // along x
  Floats y, z, border_weight;
};

struct Classified {
  alignas(64) std::array<std::uint32_t, lanes> entry;  // as an index of floats
  Floats between;                                      // fraction of the way to the next entry
};

template <bool with_border, bool nearest>
HWY_INLINE void locate(const Packet& rays, const Constants& constants, Located& out) {
  const FloatTag f;
  const IntTag d;
  const hn::RebindToUnsigned<IntTag> u;
  const Position p = position_of(rays, constants);
  std::array<Ints, 3> cell;
  std::array<Floats, 3> fraction;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = truncated(p.clamped[axis]);
    fraction[axis] = hn::Sub(p.clamped[axis], hn::ConvertTo(f, cell[axis]));
    if (nearest)
      fraction[axis] = hn::IfThenElseZero(hn::Ge(fraction[axis], hn::Set(f, 0.5F)), hn::Set(f, 1.0F));
  }

  const Ints block = block_index(hn::ShiftRight<3>(cell[0]), hn::ShiftRight<3>(cell[1]),
                                 hn::ShiftRight<3>(cell[2]), constants);
  const Ints seven = hn::Set(d, BrickStore::block_cells - 1);
  const Ints yz = hn::Or(hn::And(cell[1], seven), hn::ShiftLeft<16>(hn::And(cell[2], seven)));
  const Ints strides = hn::Set(d, BrickStore::block_row | BrickStore::block_slice << 16);
  Ints unused = hn::Zero(d);
  const Ints corner =
      hn::Add(hn::And(cell[0], seven),
              hn::ReorderWidenMulAccumulate(d, hn::BitCast(ShortTag(), yz), hn::BitCast(ShortTag(), strides),
                                            hn::Zero(d), unused));
  hn::Store(hn::BitCast(u, block), u, out.block.data());
  hn::Store(hn::BitCast(u, corner), u, out.corner.data());

  // Weights along x as negative 16-bit integers, -2^15 (1 - s) and -2^15 s: one is representable that way, and
  // a power of two leaves texel values exact.
  const Ints high = truncated(hn::MulAdd(fraction[0], hn::Set(f, 32768.0F), hn::Set(f, 0.5F)));
  out.weights = hn::Sub(hn::Xor(high, hn::Set(d, 0x8000)), hn::ShiftLeft<16>(high));
  out.y = fraction[1];
  out.z = fraction[2];

  if (with_border) {
    // Beyond the outermost texel centres the filter mixes in a constant: one axis at a time, so the weights
    // multiply.
    const Floats one = hn::Set(f, 1.0F);
    out.border_weight = one;
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Floats beyond = hn::Min(hn::Abs(hn::Sub(p.free[axis], p.clamped[axis])), one);
      out.border_weight = hn::Mul(out.border_weight, hn::NegMulAdd(beyond, constants.border_weight[axis], one));
    }
  }
}

template <bool with_border>
HWY_INLINE void classify(const Located& at, const Packet& rays, const Constants& constants, Classified& out) {
  const FloatTag f;
  const IntTag d;
  const std::uint8_t* corners[lanes];
#pragma GCC unroll 16
  for (std::size_t lane = 0; lane < lanes; ++lane)
    corners[lane] = reinterpret_cast<const std::uint8_t*>(constants.blocks[at.block[lane]]) + at.corner[lane];
  const Edges e = transposed(edges_of_column<0>(corners, at.weights), edges_of_column<1>(corners, at.weights),
                             edges_of_column<2>(corners, at.weights), edges_of_column<3>(corners, at.weights));
  Floats value =
      mix(mix(e.low_y_low_z, e.high_y_low_z, at.y), mix(e.low_y_high_z, e.high_y_high_z, at.y), at.z);
  if (with_border) value = mix(constants.border, value, at.border_weight);

  const Floats place = hn::MulAdd(value, constants.table_scale, constants.table_offset);
  const Floats kept = hn::Min(hn::Max(place, hn::Zero(f)), constants.table_last);
  const Ints entry = truncated(kept);
  out.between = hn::Sub(kept, hn::ConvertTo(f, entry));
  const auto ended = hn::RebindMask(d, hn::Gt(rays.k, rays.last));
  const hn::RebindToUnsigned<IntTag> u;
  hn::Store(hn::BitCast(u, hn::ShiftLeft<3>(hn::IfThenElse(ended, constants.clear_entry, entry))), u,
            out.entry.data());
}

HWY_INLINE void compose(const Classified& at, const Constants& constants, std::array<Floats, 4>& pixels) {
  const float* entries[lanes];
#pragma GCC unroll 16
  for (std::size_t lane = 0; lane < lanes; ++lane) entries[lane] = constants.entries + at.entry[lane];
  pixels[0] = composed<0>(pixels[0], entries, at.between);
  pixels[1] = composed<1>(pixels[1], entries, at.between);
  pixels[2] = composed<2>(pixels[2], entries, at.between);
  pixels[3] = composed<3>(pixels[3], entries, at.between);
}

/// Eight samples of every ray. Three passes: within each, samples do not wait for one another, and the
/// processor's window holds several of them; one after the other, a sample's chain of some hundred cycles would
/// be all it sees.
template <bool with_border, bool nearest>
HWY_INLINE void take_samples(Packet& rays, const Constants& constants, std::array<Floats, 4>& pixels) {
  const Floats one = hn::Set(FloatTag(), 1.0F);
  std::array<Located, samples_between_tests> located;
  std::array<Classified, samples_between_tests> classified;
  Packet ahead = rays;
  for (Located& at : located) {
    locate<with_border, nearest>(ahead, constants, at);
    ahead.k = hn::Add(ahead.k, one);
  }
  for (std::size_t i = 0; i < located.size(); ++i) {
    classify<with_border>(located[i], rays, constants, classified[i]);
    rays.k = hn::Add(rays.k, one);
  }
  for (const Classified& at : classified) compose(at, constants, pixels);
}

/// Alpha of every ray, from the blended layout to one lane per ray.
HWY_INLINE Floats alphas(const std::array<Floats, 4>& pixels) {
  const FloatTag f;
  const hn::Repartition<double, FloatTag> wide;
  const auto pair01 = hn::BitCast(wide, hn::InterleaveUpper(f, pixels[0], pixels[1]));
  const auto pair23 = hn::BitCast(wide, hn::InterleaveUpper(f, pixels[2], pixels[3]));
  return hn::BitCast(f, hn::InterleaveUpper(wide, pair01, pair23));
}

/// The packet whose lowest left pixel is (x, y) of the strip.
HWY_INLINE Packet packet_of(const RayStrip& strip, std::size_t x, std::size_t y) {
  const FloatTag f;
  const auto load = [&](const auto& values) HWY_ATTR {
    alignas(64) float packed[lanes];
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t q = 0; q < 4; ++q) packed[4 * row + q] = float(values[(y + row) * tile_width + x + q]);
    return hn::Load(f, packed);
  };
  constexpr float block_cells = BrickStore::block_cells;
  Packet rays;
  rays.k = load(strip.first);
  rays.last = load(strip.last);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rays.start[axis] = load(strip.start[axis]);
    rays.step[axis] = load(strip.step[axis]);
    rays.direction[axis] = hn::CopySign(hn::Set(f, 1.0F), rays.step[axis]);
    const Floats speed = hn::Max(hn::Abs(rays.step[axis]), hn::Set(f, 1e-20F));
    rays.steps_per_block[axis] = hn::Div(hn::Set(f, block_cells * (1 - 1e-6F)), speed);
  }
  return rays;
}

template <bool with_border, bool nearest>
void walk_strip(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  const FloatTag f;
  const IntTag d;
  const Constants constants(scene);
  const bool skips = scene.skip->empty_blocks() > 0;
  const Floats one = hn::Set(f, 1.0F);
  Ints taken = hn::Zero(d);
  for (std::size_t y = 0; y < strip_height; y += rows)
    for (std::size_t x = 0; x < tile_width; x += 4 * group) {
      Group packets;
      std::array<std::array<Floats, 4>, group> pixels;
      bool done = true;
      for (std::size_t g = 0; g < group; ++g) {
        packets[g] = packet_of(strip, x + 4 * g, y);
        pixels[g].fill(hn::Zero(f));
        done = done && packets[g].done();
      }
      while (!done) {
        if (skips) skip_empty(packets, constants);
        done = true;
        for (std::size_t g = 0; g < group; ++g) {
          Packet& rays = packets[g];
          if (rays.done()) continue;
          const Floats left = hn::Add(hn::Sub(rays.last, rays.k), one);
          const Floats block = hn::Set(f, float(samples_between_tests));
          taken = hn::Add(taken, truncated(hn::Min(hn::Max(left, hn::Zero(f)), block)));
          take_samples<with_border, nearest>(rays, constants, pixels[g]);
          const Floats room = hn::Sub(one, alphas(pixels[g]));
          const auto opaque = hn::And(hn::Lt(room, hn::Set(f, scene.termination)), hn::Le(rays.k, rays.last));
          counts.rays_terminated += hn::CountTrue(f, opaque);
          rays.k = hn::IfThenElse(opaque, hn::Add(rays.last, one), rays.k);
          done = done && rays.done();
        }
      }
      for (std::size_t g = 0; g < group; ++g)
        for (std::size_t q = 0; q < 4; ++q) {
          alignas(64) float column[lanes];
          hn::Store(pixels[g][q], f, column);
          for (std::size_t row = 0; row < rows; ++row)
            std::copy_n(column + 4 * row, 4, rgba + 4 * ((y + row) * tile_width + x + 4 * g + q));
        }
    }
  alignas(64) std::int32_t taken_by_lane[lanes];
  hn::Store(taken, d, taken_by_lane);
  for (const std::int32_t n : taken_by_lane) counts.samples_taken += std::uint64_t(n);
}

void u8_kernel(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  const auto& border = scene.has_border;
  if (scene.filter == Filter::nearest)
    walk_strip<false, true>(scene, strip, rgba, counts);
  else if (border[0] || border[1] || border[2])
    walk_strip<true, false>(scene, strip, rgba, counts);
  else
    walk_strip<false, false>(scene, strip, rgba, counts);
}

#else

void u8_kernel(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  generic_kernel(scene, strip, rgba, counts);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace understudy::volume
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "volume/raycast/ray_caster.h"

namespace understudy::volume {

HWY_EXPORT(u8_kernel);

void u8_kernel(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  HWY_DYNAMIC_DISPATCH(u8_kernel)(scene, strip, rgba, counts);
}

const char* instruction_set() {
  const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(usable & -usable);  // the best has the lowest bit
}

}  // namespace understudy::volume
#endif  // HWY_ONCE
