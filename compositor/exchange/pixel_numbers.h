// SPDX-License-Identifier: Apache-2.0
// The numbers in which pixels are sent: floats, half floats or bytes, one after the other or packed.
//
// Neighbours in a row are similar. So packing replaces each number, its bits read as an integer, by its
// difference from that of the pixel before. Zigzag coding makes natural numbers of differences of either sign,
// and those of eight pixels take as few bits each as the largest of them needs. No bit is lost. (Bits of floats
// by differences: Ratanaworabhan, Ke, Burtscher 2006; packed in four lanes: Lemire, Boytsov 2015, "Decoding
// billions of integers per second through vectorization".)
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

/// Writes bytes_per_pixel() bytes for each of the RGBA pixels at `from`.
void put_pixels(std::span<const float> from, Layout layout, std::byte* to);
/// The inverse of put_pixels().
void get_pixels(const std::byte* from, Layout layout, std::span<float> to);

/// The numbers of the last pixel, which both sides keep from span to span of one message.
using LastPixel = std::array<std::uint32_t, 4>;

/// Returns the most that spans of this many pixels take together: dissimilar numbers take slightly more than
/// unpacked, and single pixels as much as floats.
constexpr std::size_t most_packed_bytes(std::size_t pixels) {
  return 20 * pixels;
}

/// Spans are unpacked as they were packed, or in parts that are multiples of this many pixels, except the last.
constexpr std::size_t packed_block_pixels = 64;

/// Packs a span of RGBA pixels; returns how many bytes it wrote to `to`, a multiple of four. `to` has room for
/// most_packed_bytes(), and is aligned to four.
std::size_t pack_pixels(std::span<const float> from, Layout layout, LastPixel& last, std::byte* to);
/// The inverse. Returns how many bytes of `from` it read; 0 if these are too few or malformed.
std::size_t unpack_pixels(std::span<const std::byte> from, Layout layout, LastPixel& last, std::span<float> to);

}  // namespace understudy::compositor
