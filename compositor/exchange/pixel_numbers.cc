// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/pixel_numbers.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "compositor/exchange/pixel_numbers.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::compositor::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float largest_half = 65504;
constexpr std::size_t lanes = 4;

// A pixel, or one component after the other if a vector holds less (HWY_SCALAR).
using Floats = hn::CappedTag<float, lanes>;
using Words = hn::RebindToUnsigned<Floats>;
using Ints = hn::RebindToSigned<Floats>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;
using HalfWords = hn::Rebind<std::uint16_t, Floats>;
using Bytes = hn::Rebind<std::uint8_t, Floats>;
using Word = hn::Vec<Words>;

constexpr int bits_of(Layout layout) {
  return layout == Layout::rgba32f ? 32 : layout == Layout::rgba16f ? 16 : 8;
}

/// Returns components of pixels as the integers that are sent.
template <Layout layout, class D>
HWY_INLINE hn::Vec<D> numbers(D w, const float* from) {
  const hn::RebindToFloat<D> f;
  const auto value = hn::LoadU(f, from);
  if constexpr (layout == Layout::rgba32f) {
    return hn::BitCast(w, value);
  } else if constexpr (layout == Layout::rgba16f) {
    const hn::Rebind<hwy::float16_t, D> halves;
    const hn::Rebind<std::uint16_t, D> half_words;
    const auto bounded = hn::Max(hn::Min(value, hn::Set(f, largest_half)), hn::Set(f, -largest_half));
    return hn::PromoteTo(w, hn::BitCast(half_words, hn::DemoteTo(halves, bounded)));
  } else {
    const auto bounded = hn::Max(hn::Min(value, hn::Set(f, 1.0F)), hn::Zero(f));
    return hn::BitCast(w, hn::NearestInt(hn::Mul(bounded, hn::Set(f, 255.0F))));
  }
}

/// The inverse of numbers().
template <Layout layout>
HWY_INLINE void store_floats(Word value, float* to) {
  const Floats f;
  const Ints i;
  if constexpr (layout == Layout::rgba32f)
    hn::StoreU(hn::BitCast(f, value), f, to);
  else if constexpr (layout == Layout::rgba16f)
    hn::StoreU(hn::PromoteTo(f, hn::BitCast(Halves(), hn::DemoteTo(HalfWords(), hn::BitCast(i, value)))), f,
               to);
  else
    hn::StoreU(hn::Mul(hn::ConvertTo(f, hn::BitCast(i, value)), hn::Set(f, 1.0F / 255)), f, to);
}

template <Layout layout>
void put(const float* from, std::size_t floats, std::byte* to) {
  const Ints d;
  for (std::size_t i = 0; i < floats; i += hn::Lanes(d)) {
    const auto value = hn::BitCast(d, numbers<layout>(Words(), from + i));
    if constexpr (layout == Layout::rgba16f)
      hn::StoreU(hn::DemoteTo(HalfWords(), value), HalfWords(), reinterpret_cast<std::uint16_t*>(to) + i);
    else
      hn::StoreU(hn::DemoteTo(Bytes(), value), Bytes(), reinterpret_cast<std::uint8_t*>(to) + i);
  }
}

template <Layout layout>
void get(const std::byte* from, std::size_t floats, float* to) {
  const Words d;
  for (std::size_t i = 0; i < floats; i += hn::Lanes(d)) {
    if constexpr (layout == Layout::rgba16f)
      store_floats<layout>(
          hn::PromoteTo(d, hn::LoadU(HalfWords(), reinterpret_cast<const std::uint16_t*>(from) + i)), to + i);
    else
      store_floats<layout>(
          hn::PromoteTo(d, hn::LoadU(Bytes(), reinterpret_cast<const std::uint8_t*>(from) + i)), to + i);
  }
}

// A span consists of blocks of eight groups of eight pixels: a word with four bits for each group, then the
// groups. The four bits are the number of half bytes that each number of the group takes. Component c of its
// pixels goes to every fourth word from c on, without gaps. The last group of a span may have fewer than eight
// pixels: it is stored as if the last one were repeated, or with one word per number if that is shorter.
constexpr std::size_t group_pixels = 8;
constexpr std::size_t group_words = lanes * group_pixels;
constexpr std::size_t block_groups = packed_block_pixels / group_pixels;
constexpr std::uint32_t one_word_each = 15;

template <int halves, int i>
HWY_INLINE void pack_one(const std::uint32_t* from, Word& open, std::uint32_t* to) {
  constexpr int first = 4 * halves * i, shift = first % 32, end = shift + 4 * halves;
  const Words d;
  const Word value = hn::Load(d, from + lanes * i);
  if constexpr (shift == 0)
    open = value;
  else
    open = hn::Or(open, hn::ShiftLeft<shift>(value));
  if constexpr (end >= 32) hn::StoreU(open, d, to + lanes * (first / 32));
  if constexpr (end > 32) open = hn::ShiftRight<32 - shift>(value);
}

template <int halves, int... i>
HWY_INLINE void pack_group(const std::uint32_t* from, std::uint32_t* to, std::integer_sequence<int, i...>) {
  const Words d;
  for (std::size_t lane = 0; lane < lanes; lane += hn::Lanes(d)) {
    Word open = hn::Zero(d);
    (pack_one<halves, i>(from + lane, open, to + lane), ...);
  }
}

template <Layout layout, int halves, int i>
HWY_INLINE void unpack_one(const std::uint32_t* from, Word& last, float* to) {
  constexpr int first = 4 * halves * i, shift = first % 32, end = shift + 4 * halves;
  const Words d;
  if constexpr (halves > 0) {
    Word value = hn::ShiftRight<shift>(hn::LoadU(d, from + lanes * (first / 32)));
    if constexpr (end > 32)
      value = hn::Or(value, hn::ShiftLeft<32 - shift>(hn::LoadU(d, from + lanes * (first / 32 + 1))));
    if constexpr (halves < 8) value = hn::And(value, hn::Set(d, (std::uint32_t(1) << (4 * halves)) - 1));
    const Word negative = hn::Sub(hn::Zero(d), hn::And(value, hn::Set(d, 1)));
    last = hn::Add(last, hn::Xor(hn::ShiftRight<1>(value), negative));
    if constexpr (bits_of(layout) < 32)
      last = hn::And(last, hn::Set(d, ~std::uint32_t(0) >> (32 - bits_of(layout))));
  }
  store_floats<layout>(last, to + lanes * i);
}

template <Layout layout, int halves, int... i>
HWY_INLINE void unpack_group(const std::uint32_t* from, std::uint32_t* last, float* to,
                             std::integer_sequence<int, i...>) {
  const Words d;
  for (std::size_t lane = 0; lane < lanes; lane += hn::Lanes(d)) {
    Word before = hn::LoadU(d, last + lane);
    (unpack_one<layout, halves, i>(from + lane, before, to + lane), ...);
    hn::StoreU(before, d, last + lane);
  }
}

using GroupPixels = std::make_integer_sequence<int, int(group_pixels)>;

// Calls a generic lambda with `halves` as a compile-time constant.
template <class Call>
HWY_INLINE void with_constant(unsigned halves, Call call) {
  switch (halves) {
    case 0:
      return call(std::integral_constant<int, 0>());
    case 1:
      return call(std::integral_constant<int, 1>());
    case 2:
      return call(std::integral_constant<int, 2>());
    case 3:
      return call(std::integral_constant<int, 3>());
    case 4:
      return call(std::integral_constant<int, 4>());
    case 5:
      return call(std::integral_constant<int, 5>());
    case 6:
      return call(std::integral_constant<int, 6>());
    case 7:
      return call(std::integral_constant<int, 7>());
    default:
      return call(std::integral_constant<int, 8>());
  }
}

/// The last pixel before a group, then the group's numbers.
using GroupNumbers = std::array<std::uint32_t, lanes + group_words>;

/// Computes the zigzag differences of a group; returns how many half bytes the largest takes. The first pixel
/// of `group` is an input; it becomes the last pixel of this group.
template <Layout layout>
HWY_INLINE unsigned differences(const float* floats, std::uint32_t* group, std::uint32_t* to) {
  constexpr int unused_bits = 32 - bits_of(layout);
  const hn::CappedTag<std::uint32_t, group_words / 2> d;
  const hn::RebindToSigned<decltype(d)> s;
  for (std::size_t i = 0; i < group_words; i += hn::Lanes(d))
    hn::StoreU(numbers<layout>(d, floats + i), d, group + lanes + i);
  auto all = hn::Zero(d);
  for (std::size_t i = 0; i < group_words; i += hn::Lanes(d)) {
    auto difference = hn::BitCast(s, hn::Sub(hn::LoadU(d, group + lanes + i), hn::LoadU(d, group + i)));
    // Narrow numbers wrap around, so that differences are no wider than the numbers.
    if constexpr (unused_bits > 0)
      difference = hn::ShiftRight<unused_bits>(hn::ShiftLeft<unused_bits>(difference));
    const auto zigzag =
        hn::BitCast(d, hn::Xor(hn::Add(difference, difference), hn::ShiftRight<31>(difference)));
    hn::StoreU(zigzag, d, to + i);
    all = hn::Or(all, zigzag);
  }
  std::memcpy(group, group + group_words, sizeof(LastPixel));
  return unsigned(std::bit_width(hn::GetLane(hn::MaxOfLanes(d, all))) + 3) / 4;
}

/// Fills a group of fewer than eight pixels by repeating its last one.
HWY_INLINE void fill_group(const float* floats, std::size_t pixels, float* to) {
  std::memcpy(to, floats, sizeof(float) * lanes * pixels);
  for (std::size_t i = pixels; i < group_pixels; ++i)
    std::memcpy(to + lanes * i, floats + lanes * (pixels - 1), sizeof(float) * lanes);
}

template <Layout layout>
std::size_t pack(const float* from, std::size_t pixels, std::uint32_t* last, std::uint32_t* to) {
  HWY_ALIGN std::array<std::uint32_t, group_words> zigzag;
  HWY_ALIGN std::array<float, group_words> filled;
  GroupNumbers numbers_of_group;
  std::memcpy(numbers_of_group.data(), last, sizeof(LastPixel));
  std::uint32_t* const begin = to;
  while (pixels > 0) {
    std::uint32_t* const widths = to++;
    *widths = 0;
    for (std::size_t g = 0; g < block_groups && pixels > 0; ++g) {
      const std::size_t here = std::min(pixels, group_pixels);
      const float* group = from;
      if (here < group_pixels) {
        fill_group(from, here, filled.data());
        group = filled.data();
      }
      const unsigned halves = differences<layout>(group, numbers_of_group.data(), zigzag.data());
      if (halves <= here) {
        *widths |= halves << (4 * g);
        with_constant(halves, [&](auto constant) {
          pack_group<decltype(constant)::value>(zigzag.data(), to, GroupPixels());
        });
        to += lanes * halves;
      } else {
        *widths |= one_word_each << (4 * g);
        std::memcpy(to, numbers_of_group.data() + lanes, sizeof(LastPixel) * here);
        to += lanes * here;
      }
      from += lanes * here;
      pixels -= here;
    }
  }
  std::memcpy(last, numbers_of_group.data(), sizeof(LastPixel));
  return sizeof(std::uint32_t) * std::size_t(to - begin);
}

template <Layout layout>
std::size_t unpack(const std::uint32_t* from, std::size_t words, std::uint32_t* last, float* to,
                   std::size_t pixels) {
  HWY_ALIGN std::array<float, group_words> filled;
  const std::uint32_t *const begin = from, *const end = from + words;
  while (pixels > 0) {
    if (from == end) return 0;
    std::uint32_t widths = *from++;
    for (std::size_t g = 0; g < block_groups && pixels > 0; ++g, widths >>= 4U) {
      const std::size_t here = std::min(pixels, group_pixels);
      const unsigned halves = widths & 15U;
      const std::size_t taken = lanes * (halves == one_word_each ? here : halves);
      if ((halves > 8 && halves != one_word_each) || std::size_t(end - from) < taken) return 0;
      if (halves == one_word_each) {
        const Words d;
        for (std::size_t i = 0; i < taken; i += hn::Lanes(d))
          store_floats<layout>(hn::LoadU(d, from + i), to + i);
        std::memcpy(last, from + taken - lanes, sizeof(LastPixel));
      } else {
        float* const group = here < group_pixels ? filled.data() : to;
        with_constant(halves, [&](auto constant) {
          unpack_group<layout, decltype(constant)::value>(from, last, group, GroupPixels());
        });
        if (here < group_pixels) std::memcpy(to, group, sizeof(float) * lanes * here);
      }
      from += taken;
      to += lanes * here;
      pixels -= here;
    }
  }
  return sizeof(std::uint32_t) * std::size_t(from - begin);
}

void put_halves(const float* from, std::size_t floats, std::byte* to) {
  put<Layout::rgba16f>(from, floats, to);
}
void put_bytes(const float* from, std::size_t floats, std::byte* to) {
  put<Layout::rgba8>(from, floats, to);
}
void get_halves(const std::byte* from, std::size_t floats, float* to) {
  get<Layout::rgba16f>(from, floats, to);
}
void get_bytes(const std::byte* from, std::size_t floats, float* to) {
  get<Layout::rgba8>(from, floats, to);
}

std::size_t pack_as(Layout layout, const float* from, std::size_t pixels, std::uint32_t* last,
                    std::uint32_t* to) {
  switch (layout) {
    case Layout::rgba32f:
      return pack<Layout::rgba32f>(from, pixels, last, to);
    case Layout::rgba16f:
      return pack<Layout::rgba16f>(from, pixels, last, to);
    case Layout::rgba8:
      return pack<Layout::rgba8>(from, pixels, last, to);
  }
  return 0;
}

std::size_t unpack_as(Layout layout, const std::uint32_t* from, std::size_t words, std::uint32_t* last,
                      float* to, std::size_t pixels) {
  switch (layout) {
    case Layout::rgba32f:
      return unpack<Layout::rgba32f>(from, words, last, to, pixels);
    case Layout::rgba16f:
      return unpack<Layout::rgba16f>(from, words, last, to, pixels);
    case Layout::rgba8:
      return unpack<Layout::rgba8>(from, words, last, to, pixels);
  }
  return 0;
}

}  // namespace understudy::compositor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace understudy::compositor {

HWY_EXPORT(put_halves);
HWY_EXPORT(put_bytes);
HWY_EXPORT(get_halves);
HWY_EXPORT(get_bytes);
HWY_EXPORT(pack_as);
HWY_EXPORT(unpack_as);

void put_pixels(std::span<const float> from, Layout layout, std::byte* to) {
  switch (layout) {
    case Layout::rgba32f:
      std::memcpy(to, from.data(), from.size_bytes());
      break;
    case Layout::rgba16f:
      HWY_DYNAMIC_DISPATCH(put_halves)(from.data(), from.size(), to);
      break;
    case Layout::rgba8:
      HWY_DYNAMIC_DISPATCH(put_bytes)(from.data(), from.size(), to);
      break;
  }
}

void get_pixels(const std::byte* from, Layout layout, std::span<float> to) {
  switch (layout) {
    case Layout::rgba32f:
      std::memcpy(to.data(), from, to.size_bytes());
      break;
    case Layout::rgba16f:
      HWY_DYNAMIC_DISPATCH(get_halves)(from, to.size(), to.data());
      break;
    case Layout::rgba8:
      HWY_DYNAMIC_DISPATCH(get_bytes)(from, to.size(), to.data());
      break;
  }
}

std::size_t pack_pixels(std::span<const float> from, Layout layout, LastPixel& last, std::byte* to) {
  return HWY_DYNAMIC_DISPATCH(pack_as)(layout, from.data(), from.size() / 4, last.data(),
                                       reinterpret_cast<std::uint32_t*>(to));
}

std::size_t unpack_pixels(std::span<const std::byte> from, Layout layout, LastPixel& last,
                          std::span<float> to) {
  return HWY_DYNAMIC_DISPATCH(unpack_as)(layout, reinterpret_cast<const std::uint32_t*>(from.data()),
                                         from.size() / sizeof(std::uint32_t), last.data(), to.data(),
                                         to.size() / 4);
}

}  // namespace understudy::compositor
#endif
