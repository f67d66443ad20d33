// SPDX-License-Identifier: Apache-2.0
// The numbers of pixels as they travel: floats, half floats or bytes; one after the other, or packed.
//
// Neighbours on a row are alike. So what travels of packed pixels is by how much each number, its bits read as
// an integer, differs from that of the pixel before. Differences of either sign become natural numbers by
// zigzag, and those of eight pixels take as few bits each as the largest of them needs. No bit is lost. (Bits
// of floats by differences: Ratanaworabhan, Ke, Burtscher 2006; packed in four lanes: Lemire, Boytsov 2015,
// "Decoding billions of integers per second through vectorization".)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "compositor/exchange/settings.h"

namespace understudy::compositor {

constexpr std::size_t bytes_per_pixel(Layout layout) {
  return layout == Layout::rgba32f ? 16 : layout == Layout::rgba16f ? 8 : 4;
}

/// Writes bytes_per_pixel() for each of the RGBA pixels at `from`.
void put_pixels(std::span<const float> from, Layout layout, std::byte* to);
/// The other way.
void get_pixels(const std::byte* from, Layout layout, std::span<float> to);

/// The numbers of the last pixel, which both sides remember from span to span of one message.
using LastPixel = std::array<std::uint32_t, 4>;

/// Spans of so many pixels in all take no more: where their numbers are not alike a little more than unpacked,
/// and single pixels as much as floats.
constexpr std::size_t most_packed_bytes(std::size_t pixels) {
  return 20 * pixels;
}

/// Spans are unpacked as they were packed, or in parts that are multiples of so many pixels but for the last.
constexpr std::size_t packed_block_pixels = 64;

/// Packs a span of RGBA pixels; returns how many bytes were written to `to`, a multiple of four. `to` has room
/// for the most, and is aligned to four.
std::size_t pack_pixels(std::span<const float> from, Layout layout, LastPixel& last, std::byte* to);
/// The other way. Returns how many bytes of `from` it took; 0 when these are too few, or no such span.
std::size_t unpack_pixels(std::span<const std::byte> from, Layout layout, LastPixel& last, std::span<float> to);

}  // namespace understudy::compositor
