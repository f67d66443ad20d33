// SPDX-License-Identifier: Apache-2.0
// The generic kernel on the vector instructions of the machine.
//
// Early termination and empty bricks are tested once per eight samples, so that addresses never wait for
// colours.
#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

#include "volume/raycast/kernel.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/raycast/vector_kernel.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h, which defines the instruction set.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::volume {
namespace HWY_NAMESPACE {

#if UNDERSTUDY_VECTOR_KERNEL

#include "volume/blending_operator.h"
#include "volume/raycast/vector_field-inl.h"
#include "volume/raycast/vector_layer-inl.h"
#include "volume/raycast/vector_slice_segments-inl.h"
#include "volume/texel_type.h"

/// Applies a row of the fog table (added colour, weight) to `colour`; components side by side.
HWY_INLINE Floats fogged(Floats colour, Floats row) {
  const FloatTag f;
  alignas(16) static constexpr float colour_lanes[4] = {1, 1, 1, 0};
  const Floats of_colour = hn::LoadDup128(f, colour_lanes), one = hn::Set(f, 1.0F);
  const Floats weight = hn::MulAdd(of_colour, hn::Sub(hn::Broadcast<3>(row), one), one);
  return hn::MulAdd(hn::Mul(of_colour, row), hn::Broadcast<3>(colour), hn::Mul(weight, colour));
}

/// Applies fog to the colours of the current samples of `rays`.
template <typename Classified>
HWY_INLINE void lay_in_fog(const Packet& rays, const Constants& constants, const Classified& classified,
                           Colours& out) {
  const FloatTag f;
  const Position p = position_of(rays, constants);
  Floats free = constants.fog_offset;
#pragma GCC unroll 3
  for (std::size_t axis = 0; axis < 3; ++axis)
    free = hn::MulAdd(constants.fog_gradient[axis], p.free[axis], free);
  const Floats place = hn::Min(hn::Max(free, hn::Zero(f)), constants.fog_last);
  const Ints entry = truncated(place);
  const hn::RebindToUnsigned<IntTag> u;
  TablePlace at;
  at.between = hn::Sub(place, hn::ConvertTo(f, entry));
  hn::Store(hn::BitCast(u, hn::ShiftLeft<3>(entry)), u, at.entry.data());
  out[0] = fogged(colour_at<0>(classified, constants), interpolated_row<0>(at, constants.fog_rows));
  out[1] = fogged(colour_at<1>(classified, constants), interpolated_row<1>(at, constants.fog_rows));
  out[2] = fogged(colour_at<2>(classified, constants), interpolated_row<2>(at, constants.fog_rows));
  out[3] = fogged(colour_at<3>(classified, constants), interpolated_row<3>(at, constants.fog_rows));
}

template <Operator op, typename Classified>
HWY_INLINE void compose(const std::array<Classified, samples_between_tests>& samples,
                        const Constants& constants, Colours& pixels) {
  Colours mine = pixels;
  for (const Classified& sample : samples) {
    mine[0] = composed<op>(mine[0], colour_at<0>(sample, constants));
    mine[1] = composed<op>(mine[1], colour_at<1>(sample, constants));
    mine[2] = composed<op>(mine[2], colour_at<2>(sample, constants));
    mine[3] = composed<op>(mine[3], colour_at<3>(sample, constants));
  }
  pixels = mine;
}

template <typename Classified>
HWY_INLINE void compose_to_limit(const std::array<Classified, samples_between_tests>& samples,
                                 const Constants& constants, Colours& pixels) {
  const Floats limit = constants.opacity_limit;
  Colours mine = pixels;
  for (const Classified& sample : samples) {
    mine[0] = composed_to_limit(mine[0], colour_at<0>(sample, constants), limit);
    mine[1] = composed_to_limit(mine[1], colour_at<1>(sample, constants), limit);
    mine[2] = composed_to_limit(mine[2], colour_at<2>(sample, constants), limit);
    mine[3] = composed_to_limit(mine[3], colour_at<3>(sample, constants), limit);
  }
  pixels = mine;
}

template <typename Classified>
HWY_INLINE void compose(const std::array<Classified, samples_between_tests>& samples,
                        const Constants& constants, Colours& pixels) {
  switch (constants.op) {
    case Operator::over:
      if (constants.is_limited) return compose_to_limit(samples, constants, pixels);
      return compose<Operator::over>(samples, constants, pixels);
    case Operator::add:
      return compose<Operator::add>(samples, constants, pixels);
    case Operator::max:
      return compose<Operator::max>(samples, constants, pixels);
    case Operator::min:
      return compose<Operator::min>(samples, constants, pixels);
    case Operator::first_hit:
      return compose<Operator::first_hit>(samples, constants, pixels);
  }
}

/// Takes eight samples of every ray, in three passes. Within a pass, samples are independent, so that several
/// fit into the processor's out-of-order window; sample by sample, the window would contain only one sample's
/// dependency chain of some hundred cycles.
template <typename Source>
HWY_INLINE void take_samples(Packet& rays, const Constants& constants, Source source, Colours& pixels) {
  using Classified = std::conditional_t<Source::scalar, TablePlace, Colours>;
  const Floats one = hn::Set(FloatTag(), 1.0F);
  std::array<Located, samples_between_tests> located;
  std::array<Classified, samples_between_tests> classified;
  const Packet before = rays;
  Packet ahead = rays;
  for (Located& at : located) {
    locate(position_of(ahead, constants), constants, at);
    ahead.k = hn::Add(ahead.k, one);
  }
  for (std::size_t i = 0; i < located.size(); ++i) {
    classify(located[i], rays, constants, source, classified[i]);
    rays.k = hn::Add(rays.k, one);
  }
  if (constants.fog_rows == nullptr) return compose(classified, constants, pixels);
  std::array<Colours, samples_between_tests> seen;
  Packet behind = before;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    lay_in_fog(behind, constants, classified[i], seen[i]);
    behind.k = hn::Add(behind.k, one);
  }
  compose(seen, constants, pixels);
}

/// Takes eight slice segments of every ray, as take_samples() takes samples.
template <typename Source>
HWY_INLINE void take_segments(Packet& rays, const Constants& constants, Source source, Colours& pixels) {
  const Floats one = hn::Set(FloatTag(), 1.0F);
  std::array<Located, samples_between_tests> front, back;
  std::array<SegmentIndex, samples_between_tests> classified;
  Packet ahead = rays;
  for (std::size_t i = 0; i < front.size(); ++i) {
    locate(position_of(ahead, constants), constants, front[i]);
    locate(behind(ahead, constants), constants, back[i]);
    ahead.k = hn::Add(ahead.k, one);
  }
  for (std::size_t i = 0; i < classified.size(); ++i) {
    classify_slice_segment(front[i], back[i], rays, constants, source, classified[i]);
    rays.k = hn::Add(rays.k, one);
  }
  compose(classified, constants, pixels);
}

/// Excludes the last sample of every ray. Rays without other samples stay at it, where it is safe to read, and
/// are done.
HWY_INLINE void leave_last_sample(Packet& rays) {
  const Floats one = hn::Set(FloatTag(), 1.0F);
  const Floats before = hn::Sub(rays.last, one);
  const auto others = hn::Le(rays.k, before);
  rays.last = hn::IfThenElse(others, before, rays.k);
  rays.k = hn::IfThenElse(others, rays.k, hn::Add(rays.k, one));
}

/// Takes the last sample of every ray that has one; it represents a layer of the given length.
template <typename Source>
HWY_INLINE void take_last_sample(Packet& rays, Floats length, const Constants& constants, Source source,
                                 Colours& pixels) {
  TablePlace place;
  Located at;
  locate(position_of(rays, constants), constants, at);
  classify(at, rays, constants, source, place);
  Colours colours{colour_at<0>(place, constants), colour_at<1>(place, constants),
                  colour_at<2>(place, constants), colour_at<3>(place, constants)};
  resize_layers(length, colours);
  pixels[0] = composed<Operator::over>(pixels[0], colours[0]);
  pixels[1] = composed<Operator::over>(pixels[1], colours[1]);
  pixels[2] = composed<Operator::over>(pixels[2], colours[2]);
  pixels[3] = composed<Operator::over>(pixels[3], colours[3]);
}

/// The sum of components of each ray's maximum so far, added up in the same order as by block_bounds().
HWY_INLINE Floats sum_seen(const std::array<Floats, 4>& pixels) {
  const FloatTag f;
  const hn::Repartition<double, FloatTag> wide;
  std::array<Floats, 4> sums;
#pragma GCC unroll 4
  for (std::size_t q = 0; q < 4; ++q) {
    const Floats pairs = hn::Add(pixels[q], hn::Shuffle2301(pixels[q]));
    sums[q] = hn::Add(pairs, hn::Shuffle1032(pairs));
  }
  const auto pair01 = hn::BitCast(wide, hn::InterleaveLower(f, sums[0], sums[1]));
  const auto pair23 = hn::BitCast(wide, hn::InterleaveLower(f, sums[2], sums[3]));
  return hn::BitCast(f, hn::InterleaveLower(wide, pair01, pair23));
}

/// `slice_segments`: takes segments instead of samples. `whole_rays`: samples cover their rays, so that the
/// last one represents a layer of its own length.
template <bool slice_segments, bool whole_rays, typename Source>
void walk_packet(const Scene& scene, const RayPacket& packet, Source source, float* rgba,
                 KernelCounts& counts) {
  const FloatTag f;
  const IntTag d;
  const Constants constants(scene, source);
  const Floats one = hn::Set(f, 1.0F);
  Ints taken = hn::Zero(d), hidden = hn::Zero(d);
  for (std::size_t y = 0; y < packet_height; y += rows)
    for (std::size_t x = 0; x < tile_width; x += 4 * group) {
      Group packets;
      std::array<Colours, group> pixels;
      std::array<Floats, group> last;
      std::array<hn::Mask<FloatTag>, group> exists;
      bool done = true;
      for (std::size_t g = 0; g < group; ++g) {
        packets[g] = packet_of(packet, x + 4 * g, y);
        pixels[g].fill(constants.neutral);
        if constexpr (whole_rays) {
          last[g] = packets[g].last;
          exists[g] = hn::Le(packets[g].k, last[g]);
          leave_last_sample(packets[g]);
        }
        done = done && packets[g].done();
      }
      while (!done) {
        if (constants.bounds != nullptr) {
          std::array<Floats, group> shown;
          for (std::size_t g = 0; g < group; ++g) shown[g] = sum_seen(pixels[g]);
          skip_exhausted(packets, shown, constants);
        } else if (constants.skips) {
          skip_empty(packets, constants);
        }
        done = true;
        for (std::size_t g = 0; g < group; ++g) {
          Packet& rays = packets[g];
          if (rays.done()) continue;
          const Floats left = hn::Add(hn::Sub(rays.last, rays.k), one);
          const Floats block = hn::Set(f, float(samples_between_tests));
          taken = hn::Add(taken, truncated(hn::Min(hn::Max(left, hn::Zero(f)), block)));
          if constexpr (slice_segments) {
            take_segments(rays, constants, source, pixels[g]);
          } else {
            take_samples(rays, constants, source, pixels[g]);
          }
          const Floats room = hn::Sub(one, alphas(pixels[g]));
          const auto opaque = hn::And(hn::Lt(room, constants.termination), hn::Le(rays.k, rays.last));
          counts.rays_terminated += hn::CountTrue(f, opaque);
          const Floats unseen = hn::Add(hn::Sub(rays.last, rays.k), one);
          hidden = hn::Add(hidden, truncated(hn::IfThenElseZero(opaque, unseen)));
          rays.k = hn::IfThenElse(opaque, hn::Add(rays.last, one), rays.k);
          done = done && rays.done();
        }
      }
      if constexpr (whole_rays) {
        for (std::size_t g = 0; g < group; ++g) {
          packets[g].last = last[g];
          packets[g].k = hn::IfThenElse(exists[g], last[g], hn::Add(last[g], one));
          taken = hn::Sub(taken, hn::VecFromMask(d, hn::RebindMask(d, exists[g])));
          take_last_sample(packets[g], values_of_rays(packet.last_length, x + 4 * g, y), constants, source,
                           pixels[g]);
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
  counts.samples_taken += total(taken);
  counts.samples_hidden += total(hidden);
}

const char* target_name() {
  return hwy::TargetName(HWY_TARGET);
}

void vector_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  const auto walk = [&](auto source) {
    if (scene.pairs != nullptr) return walk_packet<true, false>(scene, packet, source, rgba, counts);
    if (scene.cover_whole_ray) return walk_packet<false, true>(scene, packet, source, rgba, counts);
    walk_packet<false, false>(scene, packet, source, rgba, counts);
  };
  switch (scene.store->description().type) {
    case TexelType::u8:
      if (scene.filter == Filter::linear_8_bit)
        return walk_packet<false, false>(scene, packet, RoundedBytes8(), rgba, counts);
      return walk(Bytes8());
    case TexelType::u16:
      return walk(Shorts16());
    case TexelType::f32:
      return walk(Floats32());
    case TexelType::rgba8:
      return walk_packet<false, false>(scene, packet, Colours8(), rgba, counts);
  }
}

#else

const char* target_name() {
  return "scalar";
}

void vector_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  generic_kernel(scene, packet, rgba, counts);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace understudy::volume
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace understudy::volume {

HWY_EXPORT(vector_kernel);
HWY_EXPORT(target_name);

void vector_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  HWY_DYNAMIC_DISPATCH(vector_kernel)(scene, packet, rgba, counts);
}

const char* instruction_set() {
  return HWY_DYNAMIC_DISPATCH(target_name)();
}

}  // namespace understudy::volume
#endif  // HWY_ONCE
