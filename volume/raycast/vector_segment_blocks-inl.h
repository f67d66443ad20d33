// SPDX-License-Identifier: Apache-2.0
// Walks along a packet's rays, eight segments at a time: their ends, colours, surfaces that split them, light,
// and compositing into the pixels. A part of vector_segments-inl.h, included there once per instruction set,
// after the functions that it calls.

/// The ends of eight segments of every ray, and their classification.
template <bool pre_integrated>
struct SegmentBlock {
  using Classified = std::conditional_t<pre_integrated, SegmentPlace, TablePlace>;

  bool inside = false;        // all segments exist and are one step long
  bool in_one_piece = false;  // and, pre-integrated, none crosses an end of the table
  std::array<Floats, samples_between_tests + 1> u, values;
  std::array<Classified, samples_between_tests> classified;

  Mask present(const SegmentPacket& rays, std::size_t i) const {
    return hn::Le(hn::Add(rays.k, hn::Set(FloatTag(), float(i))), rays.last);
  }
};

template <bool pre_integrated>
HWY_INLINE void find_ends(const SegmentPacket& rays, SegmentBlock<pre_integrated>& block) {
  const FloatTag f;
  const Floats beyond = hn::Add(rays.k, hn::Set(f, float(samples_between_tests)));
  const Floats none_after = hn::Add(rays.last, hn::Set(f, 1.0F));
  const Mask inside =
      hn::And(hn::Ge(rays.k, hn::Max(rays.begin, hn::Zero(f))), hn::Le(beyond, hn::Min(rays.end, none_after)));
  block.inside = hn::AllTrue(f, inside);
  for (std::size_t i = 0; i <= samples_between_tests; ++i) {
    const Floats k = hn::Add(rays.k, hn::Set(f, float(i)));
    block.u[i] = block.inside ? k : on_ray(rays, k);
  }
}

template <bool pre_integrated, typename Source>
HWY_INLINE void classify_block(SegmentPacket& rays, const SegmentConstants& constants, Source source,
                               SegmentBlock<pre_integrated>& block) {
  const FloatTag f;
  const Floats zero = hn::Zero(f);
  std::array<Located, samples_between_tests> located;
  for (std::size_t i = 0; i < samples_between_tests; ++i)
    locate(place_at(rays, block.u[i + 1], constants), constants, located[i]);
  if (!rays.known) rays.value = value_at(place_at(rays, block.u[0], constants), constants, source);
  block.values[0] = rays.value;
  block.in_one_piece = block.inside;
  if constexpr (pre_integrated) {
    AxisPlace front = place_on_axis(rays.value, constants);
    for (std::size_t i = 0; i < samples_between_tests; ++i) {
      block.values[i + 1] = value_of(located[i], constants, source);
      const AxisPlace back = place_on_axis(block.values[i + 1], constants);
      Ints corner = corner_of_pair(front, back, constants);
      if (std::is_same_v<Source, Floats32> || !block.inside) {
        Mask absent = hn::Not(block.present(rays, i));
        if constexpr (std::is_same_v<Source, Floats32>)
          absent = hn::Or(absent, hn::Or(hn::IsNaN(block.values[i]), hn::IsNaN(block.values[i + 1])));
        corner = hn::IfThenElse(hn::RebindMask(IntTag(), absent), constants.neutral_entry, corner);
      }
      set_pair(front, back, corner, block.classified[i]);
      front = back;
    }
    if (constants.values_beyond) {
      Mask parted = hn::Lt(hn::Zero(f), hn::Zero(f));
      for (std::size_t i = 0; i < samples_between_tests; ++i)
        parted = hn::Or(parted, PlacedEnds(block.values[i], block.values[i + 1], constants).part());
      block.in_one_piece = block.inside && hn::AllFalse(f, parted);
    }
  } else {
    for (std::size_t i = 0; i < samples_between_tests; ++i) {
      block.values[i + 1] = value_of(located[i], constants, source);
      const Mask before = hn::Lt(hn::Add(rays.k, hn::Set(f, float(i))), zero);
      look_up(block.values[i], hn::Or(before, hn::Not(block.present(rays, i))), constants, source,
              block.classified[i]);
    }
  }
}

/// Finds the segments that surfaces split in some ray. Returns false if there are none.
template <bool pre_integrated, typename Source>
HWY_INLINE bool find_parted(const SegmentPacket& rays, const SegmentConstants& constants, Source,
                            const SegmentBlock<pre_integrated>& block,
                            std::array<bool, samples_between_tests>& parted) {
  const FloatTag f;
  bool any_parted = false;
  for (std::size_t l = 0; l < constants.levels; ++l) {
    Mask parts = hn::Lt(hn::Zero(f), hn::Zero(f));
    for (std::size_t i = 0; i < samples_between_tests; ++i)
      parts = hn::Or(parts, passes<Source>(block.values[i], block.values[i + 1], constants.level[l]));
    if (hn::AllFalse(f, parts)) continue;
    for (std::size_t i = 0; i < samples_between_tests; ++i)
      parted[i] =
          parted[i] ||
          !hn::AllFalse(f, hn::And(block.present(rays, i),
                                   passes<Source>(block.values[i], block.values[i + 1], constants.level[l])));
    any_parted = true;
  }
  return any_parted;
}

/// Lights the colours of segments, in passes within which segments are independent.
template <bool pre_integrated, typename Source>
HWY_INLINE void light_block(const SegmentPacket& rays, const SegmentConstants& constants, Source source,
                            const SegmentBlock<pre_integrated>& block,
                            std::array<Colours, samples_between_tests>& colours) {
  const FloatTag f;
  std::array<Surroundings, samples_between_tests> around;
  std::array<Slope, samples_between_tests> slopes;
  std::array<bool, samples_between_tests> shown, inner{};
  bool any_shown = false;
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    shown[i] = show(colours[i]);
    any_shown = any_shown || shown[i];
  }
  if (!any_shown) return;
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    if (!shown[i]) continue;
    const Floats middle = hn::Mul(hn::Set(f, 0.5F), hn::Add(block.u[i], block.u[i + 1]));
    const Position p = place_at(rays, pre_integrated ? middle : block.u[i], constants);
    inner[i] = look_around(p, block.present(rays, i), constants, around[i]);
    if (!inner[i]) find_clamped_slope(p, constants, source, slopes[i]);
  }
  for (std::size_t i = 0; i < samples_between_tests; ++i)
    if (inner[i]) find_slope(around[i], constants, source, slopes[i]);
  std::array<Brightness, samples_between_tests> bright;
  for (std::size_t i = 0; i < samples_between_tests; ++i) {
    bright[i].gleam = hn::Zero(f);
    if (shown[i]) find_cosines(rays, slopes[i], constants, source, bright[i]);
  }
  if (constants.gleams) raise(constants, bright);
  for (std::size_t i = 0; i < samples_between_tests; ++i)
    if (shown[i]) light_up(bright[i], constants, colours[i]);
}

/// Takes eight segments of every ray. Whole segments that no surface splits are composited like samples.
template <bool pre_integrated, bool lit, typename Source>
HWY_INLINE void take_segments(SegmentPacket& rays, const SegmentConstants& constants, Source source,
                              Colours& pixels) {
  const FloatTag f;
  SegmentBlock<pre_integrated> block;
  find_ends(rays, block);
  classify_block(rays, constants, source, block);
  std::array<bool, samples_between_tests> parted{};
  const bool any_parted = find_parted(rays, constants, source, block, parted);

  if (!lit && !constants.is_limited && !any_parted && (!pre_integrated || block.in_one_piece)) {
    Colours mine = pixels;
    for (const auto& at : block.classified) {
      mine[0] = composed<Operator::over>(mine[0], colour_at<0>(at, constants));
      mine[1] = composed<Operator::over>(mine[1], colour_at<1>(at, constants));
      mine[2] = composed<Operator::over>(mine[2], colour_at<2>(at, constants));
      mine[3] = composed<Operator::over>(mine[3], colour_at<3>(at, constants));
    }
    pixels = mine;
  } else {
    std::array<Colours, samples_between_tests> colours;
    for (std::size_t i = 0; i < samples_between_tests; ++i) {
      if (pre_integrated && !block.in_one_piece) {
        show_between(block.values[i], block.values[i + 1], hn::Sub(block.u[i + 1], block.u[i]),
                     hn::Not(block.present(rays, i)), constants, source, colours[i]);
      } else {
        colours_of(block.classified[i], constants, colours[i]);
      }
    }
    if constexpr (lit) light_block(rays, constants, source, block, colours);
    for (std::size_t i = 0; i < samples_between_tests; ++i) {
      if (!parted[i]) {
        compose_sample(colours[i], constants, pixels);
        continue;
      }
      Segment segment;
      segment.begin = block.u[i];
      segment.end = block.u[i + 1];
      segment.from = place_at(rays, block.u[i], constants);
      segment.to = place_at(rays, block.u[i + 1], constants);
      segment.front = block.values[i];
      segment.back = block.values[i + 1];
      Floats square = hn::Zero(f);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Floats way = hn::Sub(segment.to.free[axis], segment.from.free[axis]);
        square = hn::MulAdd(way, way, square);
      }
      segment.cells = hn::Sqrt(square);
      compose_surfaces<pre_integrated>(rays, segment, block.present(rays, i), lit, constants, source,
                                       colours[i], pixels);
    }
  }
  rays.value = block.values[samples_between_tests];
  rays.known = true;
  rays.k = hn::Add(rays.k, hn::Set(f, float(samples_between_tests)));
}

/// The rays whose lower left one is ray (x, y) of the packet.
HWY_INLINE SegmentPacket segment_packet_of(const RayPacket& packet, std::size_t x, std::size_t y,
                                           const SegmentConstants& constants) {
  const FloatTag f;
  const PreparedLight* const prepared_light = constants.prepared_light;
  SegmentPacket rays;
  static_cast<Packet&>(rays) = packet_of(packet, x, y);
  alignas(64) std::array<std::array<float, lanes>, 8> packed{};
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t ray = (y + lane / 4) * tile_width + x + lane % 4;
    packed[0][lane] = packet.begin[ray];
    packed[1][lane] = packet.end[ray];
    if (prepared_light == nullptr) continue;
    const std::array<float, 3> step{packet.step[0][ray], packet.step[1][ray], packet.step[2][ray]};
    const std::array<float, 3> light = prepared_light->light(step), half = prepared_light->half(step);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      packed[2 + axis][lane] = light[axis] * constants.normal_of_slope;
      packed[5 + axis][lane] = half[axis] * constants.normal_of_slope;
    }
  }
  rays.begin = hn::Load(f, packed[0].data());
  rays.end = hn::Load(f, packed[1].data());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rays.light[axis] = hn::Load(f, packed[2 + axis].data());
    rays.half[axis] = hn::Load(f, packed[5 + axis].data());
  }
  rays.value = hn::Zero(f);
  return rays;
}

HWY_INLINE void skip_empty_segments(SegmentGroup& packets, const SegmentConstants& constants) {
  for (bool again = true; again;) {
    again = false;
#pragma GCC unroll 2
    for (SegmentPacket& rays : packets)
      if (skip_empty_runs_of_segments(rays, constants)) {
        rays.known = false;
        again = true;
      }
  }
}

template <bool pre_integrated, bool lit, typename Source>
void walk_segments_of_packet(const Scene& scene, const RayPacket& packet, Source source, float* rgba,
                             KernelCounts& counts) {
  const FloatTag f;
  const IntTag d;
  const SegmentConstants constants(scene, source);
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
          const Floats left = hn::Add(hn::Sub(rays.last, rays.k), one);
          const Floats block = hn::Set(f, float(samples_between_tests));
          taken = hn::Add(taken, truncated(hn::Min(hn::Max(left, hn::Zero(f)), block)));
          take_segments<pre_integrated, lit>(rays, constants, source, pixels[g]);
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

template <bool pre_integrated>
void walk_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  const auto walk = [&](auto source) {
    return scene.segments->lit_samples
               ? walk_segments_of_packet<pre_integrated, true>(scene, packet, source, rgba, counts)
               : walk_segments_of_packet<pre_integrated, false>(scene, packet, source, rgba, counts);
  };
  switch (scene.store->description().type) {
    case TexelType::u8:
      if constexpr (!pre_integrated)
        if (scene.filter == Filter::linear_8_bit)
          return walk_segments_of_packet<false, true>(scene, packet, RoundedBytes8(), rgba, counts);
      return walk(Bytes8());
    case TexelType::u16:
      return walk(Shorts16());
    case TexelType::f32:
      return walk(Floats32());
    case TexelType::rgba8:  // refused by validate()
      return;
  }
}
