// SPDX-License-Identifier: Apache-2.0
// The generic adaptive kernel on the vector instructions of the machine. Eight parts of steps per ray are
// queued, and then sampled as vector_kernel.cc takes samples.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "volume/raycast/kernel.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/surface_search.h"
#include "volume/raycast/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/raycast/vector_adaptive.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h, which defines the instruction set.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::volume {
namespace HWY_NAMESPACE {

#if UNDERSTUDY_VECTOR_KERNEL

#include "volume/blending_operator.h"
#include "volume/raycast/vector_segments-inl.h"
#include "volume/texel_type.h"

struct AdaptiveConstants : SegmentConstants {
  template <typename Source>
  AdaptiveConstants(const Scene& scene, Source source)
      : SegmentConstants(scene, source),
        classes(reinterpret_cast<const std::int32_t*>(scene.division->classes())),
        divisions(reinterpret_cast<const std::int32_t*>(scene.division->divisions())) {
    const FloatTag f;
    const IntTag d;
    const PartTable& parts = *scene.parts;
    table_low = hn::Set(f, Source::factor * (parts.low() - Source::zero));
    table_scale = hn::Set(f, parts.scale() / Source::factor);
    table_last = hn::Set(f, parts.last());
    this->entries = parts.rows();
    neutral_entry = hn::Set(d, std::int32_t(parts.neutral_entry()));
    entries_of_division = hn::Set(d, std::int32_t(parts.entries()));
    bins_an_entry = hn::Set(f, float(StepDivision::bins - 1) / parts.last());
  }

  const std::int32_t *classes, *divisions;  // a byte each; gathered four at a time
  Ints entries_of_division;
  Floats bins_an_entry;
};

HWY_INLINE Floats place_of(Floats value, const AdaptiveConstants& constants) {
  const Floats place = hn::Mul(hn::Sub(value, constants.table_low), constants.table_scale);
  return hn::Min(hn::Max(place, hn::Zero(FloatTag())), constants.table_last);  // 0 for NaN
}

HWY_INLINE Ints classes_at(const Located& at, const AdaptiveConstants& constants) {
  const IntTag d;
  const hn::RebindToUnsigned<IntTag> u;
  const Ints block = hn::BitCast(d, hn::Load(u, at.block.data()));
  return hn::And(hn::GatherOffset(d, constants.classes, block), hn::Set(d, 255));
}

/// How often steps of these classes are halved, by the field's value in their middle.
HWY_INLINE Ints divisions_of(Ints of_block, Floats value, const AdaptiveConstants& constants) {
  const IntTag d;
  const Ints bin = truncated(hn::Mul(place_of(value, constants), constants.bins_an_entry));
  const Ints at = hn::Add(hn::Mul(of_block, hn::Set(d, StepDivision::bins)), bin);
  return hn::And(hn::GatherOffset(d, constants.divisions, at), hn::Set(d, 255));
}

/// Eight parts of every ray, in order.
struct PartQueue {
  std::size_t count = 0;
  std::array<Floats, samples_between_tests> u;
  std::array<Floats, samples_between_tests> value;  // if known
  std::array<bool, samples_between_tests> known{};
  std::array<Floats, samples_between_tests> length;  // of their steps
  std::array<Ints, samples_between_tests> first_entry;
  std::array<Mask, samples_between_tests> present;
  bool cut = false;  // some step is clipped
};

template <typename Source>
HWY_INLINE void show_parts(const SegmentPacket& rays, PartQueue& queue, const AdaptiveConstants& constants,
                           Source source, Colours& pixels) {
  const FloatTag f;
  const hn::RebindToUnsigned<IntTag> u;
  if (queue.count == 0) return;
  for (std::size_t i = queue.count; i < samples_between_tests; ++i) {
    queue.known[i] = true;
    queue.value[i] = hn::Zero(f);
    queue.length[i] = queue.length[0];
    queue.first_entry[i] = queue.first_entry[0];
    queue.present[i] = hn::Lt(hn::Zero(f), hn::Zero(f));
  }
  std::array<Located, samples_between_tests> located;
  std::array<TablePlace, samples_between_tests> places;
  for (std::size_t i = 0; i < located.size(); ++i)
    if (!queue.known[i]) locate(place_at(rays, queue.u[i], constants), constants, located[i]);
  for (std::size_t i = 0; i < located.size(); ++i) {
    const Floats value = queue.known[i] ? queue.value[i] : value_of(located[i], constants, source);
    const Floats kept = place_of(value, constants);
    const Ints entry = truncated(kept);
    places[i].between = hn::Sub(kept, hn::ConvertTo(f, entry));
    Mask present = queue.present[i];
    if constexpr (std::is_same_v<Source, Floats32>) present = hn::And(present, hn::Not(hn::IsNaN(value)));
    const Ints chosen = hn::IfThenElse(hn::RebindMask(IntTag(), present), hn::Add(entry, queue.first_entry[i]),
                                       constants.neutral_entry);
    hn::Store(hn::BitCast(u, hn::ShiftLeft<3>(chosen)), u, places[i].entry.data());
  }
  Colours mine = pixels;
  if (queue.cut) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      Colours colours;
      colours_of(places[i], constants, colours);
      shorten(queue.length[i], colours);
      compose_over(colours, mine);
    }
  } else {
    for (const TablePlace& at : places) {
      mine[0] = composed<Operator::over>(mine[0], colour_at<0>(at, constants));
      mine[1] = composed<Operator::over>(mine[1], colour_at<1>(at, constants));
      mine[2] = composed<Operator::over>(mine[2], colour_at<2>(at, constants));
      mine[3] = composed<Operator::over>(mine[3], colour_at<3>(at, constants));
    }
  }
  pixels = mine;
  queue.count = 0;
  queue.cut = false;
}

/// Takes eight steps of every ray. Adds the number of parts sampled to `taken`.
template <typename Source>
HWY_INLINE void take_steps(SegmentPacket& rays, const AdaptiveConstants& constants, Source source, Ints& taken,
                           Colours& pixels) {
  const FloatTag f;
  const IntTag d;
  const Floats half = hn::Set(f, 0.5F), one = hn::Set(f, 1.0F);
  const Floats beyond = hn::Set(f, float(samples_between_tests));
  const Mask inside = hn::And(hn::Ge(rays.k, hn::Max(rays.begin, hn::Zero(f))),
                              hn::Le(hn::Add(rays.k, beyond), hn::Min(rays.end, hn::Add(rays.last, one))));
  const bool whole = hn::AllTrue(f, inside);
  std::array<Floats, samples_between_tests + 1> u;
  for (std::size_t i = 0; i <= samples_between_tests; ++i)
    u[i] = on_ray(rays, hn::Add(rays.k, hn::Set(f, float(i))));
  // Samples the middles of all steps; undivided steps need no other samples.
  std::array<Located, samples_between_tests> located;
  std::array<Floats, samples_between_tests> middle, value;
  std::array<Ints, samples_between_tests> divisions;
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    middle[i] = hn::Add(hn::Mul(half, hn::Sub(u[i + 1], u[i])), u[i]);
    locate(place_at(rays, middle[i], constants), constants, located[i]);
  }
  Ints any = hn::Zero(d);
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    value[i] = value_of(located[i], constants, source);
    divisions[i] = classes_at(located[i], constants);
    any = hn::Or(any, divisions[i]);
  }
  if (!hn::AllTrue(d, hn::Eq(any, hn::Zero(d)))) {
    any = hn::Zero(d);
    for (std::size_t i = 0; i < samples_between_tests; ++i) {
      divisions[i] = divisions_of(divisions[i], value[i], constants);
      any = hn::Or(any, divisions[i]);
    }
  }
  PartQueue queue;
  const bool undivided = whole && hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
  Mask open = hn::Le(rays.k, rays.last);
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    const Mask present = hn::And(open, hn::Le(hn::Add(rays.k, hn::Set(f, float(i))), rays.last));
    if (undivided) {
      queue.value[i] = value[i];
      queue.known[i] = true;
      queue.length[i] = one;
      queue.first_entry[i] = hn::Zero(d);
      queue.present[i] = present;
      taken = hn::Sub(taken, hn::VecFromMask(d, hn::RebindMask(d, present)));
      queue.count = i + 1;
      continue;
    }
    const Floats length = hn::Sub(u[i + 1], u[i]);
    const Floats parts = hn::ConvertTo(f, hn::Shl(hn::Set(d, 1), divisions[i]));
    const Floats part = hn::Div(one, parts);
    const bool known = hn::AllTrue(d, hn::Eq(divisions[i], hn::Zero(d)));
    for (Floats number = half;; number = hn::Add(number, one)) {
      const Mask mine = hn::And(hn::And(present, open), hn::Lt(number, parts));
      if (hn::AllFalse(f, mine)) break;
      const std::size_t at = queue.count++;
      queue.u[at] = hn::Add(hn::Mul(hn::Mul(hn::Min(number, parts), part), length), u[i]);
      queue.value[at] = value[i];
      queue.known[at] = known;
      queue.length[at] = length;
      queue.first_entry[at] = hn::Mul(divisions[i], constants.entries_of_division);
      queue.present[at] = mine;
      queue.cut = queue.cut || !whole;
      taken = hn::Sub(taken, hn::VecFromMask(d, hn::RebindMask(d, mine)));
      if (queue.count < samples_between_tests) continue;
      show_parts(rays, queue, constants, source, pixels);
      open = hn::And(open, hn::Ge(hn::Sub(one, alphas(pixels)), constants.termination));
    }
  }
  show_parts(rays, queue, constants, source, pixels);
  rays.k = hn::Add(rays.k, beyond);
}

template <typename Source>
void walk_steps_of_packet(const Scene& scene, const RayPacket& packet, Source source, float* rgba,
                          KernelCounts& counts) {
  const FloatTag f;
  const IntTag d;
  const AdaptiveConstants constants(scene, source);
  const Floats one = hn::Set(f, 1.0F);
  Ints taken = hn::Zero(d), hidden = hn::Zero(d);
  for (std::size_t y = 0; y < packet_height; y += rows)
    for (std::size_t x = 0; x < tile_width; x += 4 * group) {
      SegmentGroup packets;
      std::array<Colours, group> pixels;
      bool done = true;
      for (std::size_t g = 0; g < group; ++g) {
        packets[g] = segment_packet_of(packet, x + 4 * g, y, constants);
        pixels[g].fill(hn::Zero(f));
        done = done && packets[g].done();
      }
      while (!done) {
        if (constants.skips) skip_empty_segments(packets, constants);
        done = true;
        for (std::size_t g = 0; g < group; ++g) {
          SegmentPacket& rays = packets[g];
          if (rays.done()) continue;
          take_steps(rays, constants, source, taken, pixels[g]);
          const Floats room = hn::Sub(one, alphas(pixels[g]));
          const auto opaque = hn::And(hn::Lt(room, constants.termination), hn::Le(rays.k, rays.last));
          counts.rays_terminated += hn::CountTrue(f, opaque);
          const Floats unseen = hn::Add(hn::Sub(rays.last, rays.k), one);
          hidden = hn::Add(hidden, truncated(hn::IfThenElseZero(opaque, unseen)));
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
  counts.samples_taken += total(taken);
  counts.samples_hidden += total(hidden);
}

void vector_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  switch (scene.store->description().type) {
    case TexelType::u8:
      return walk_steps_of_packet(scene, packet, Bytes8(), rgba, counts);
    case TexelType::u16:
      return walk_steps_of_packet(scene, packet, Shorts16(), rgba, counts);
    case TexelType::f32:
      return walk_steps_of_packet(scene, packet, Floats32(), rgba, counts);
    case TexelType::rgba8:  // refused by validate()
      return;
  }
}

#else

void vector_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  generic_adaptive(scene, packet, rgba, counts);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace understudy::volume
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace understudy::volume {

HWY_EXPORT(vector_adaptive);

void vector_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  HWY_DYNAMIC_DISPATCH(vector_adaptive)(scene, packet, rgba, counts);
}

}  // namespace understudy::volume
#endif  // HWY_ONCE
