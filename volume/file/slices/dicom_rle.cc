// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_rle.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace understudy::volume {

namespace {

// The number of segments, and the offsets of at most 15.
constexpr std::size_t rle_header_bytes = 64;

std::size_t little_endian(std::span<const std::byte> bytes) {
  std::size_t number = 0;
  for (std::size_t i = 4; i > 0; --i) number = number << 8 | std::to_integer<std::size_t>(bytes[i - 1]);
  return number;
}

/// Decodes one byte of each scalar (PackBits): every `step`th byte of `plane`, starting with the first.
void unpack(std::span<const std::byte> packed, std::size_t step, std::span<std::byte> plane) {
  std::size_t at = 0, next = 0;
  const auto put = [&](std::byte value) {
    if (next < plane.size()) plane[next] = value;  // rows may be padded at the end
    next += step;
  };
  while (next < plane.size()) {
    if (at >= packed.size()) throw std::runtime_error("its runs end too early");
    const int code = std::to_integer<int>(packed[at++]);
    const int length = code < 128 ? code : code - 256;  // two's complement
    if (length >= 0) {
      const std::size_t count = std::size_t(length) + 1;
      if (count > packed.size() - at) throw std::runtime_error("its runs end too early");
      for (std::size_t i = 0; i < count; ++i) put(packed[at++]);
    } else if (length != -128) {
      if (at >= packed.size()) throw std::runtime_error("its runs end too early");
      for (int i = 0; i < 1 - length; ++i) put(packed[at]);
      ++at;
    }
  }
}

}  // namespace

void decode_dicom_rle(std::span<const std::byte> image, std::size_t bytes_of_scalar,
                      std::span<std::byte> scalars) {
  if (image.size() < rle_header_bytes || little_endian(image) != bytes_of_scalar)
    throw std::runtime_error("its run-length header is damaged");
  const auto begin_of = [&](std::size_t segment) {
    return segment < bytes_of_scalar ? little_endian(image.subspan(4 * (segment + 1))) : image.size();
  };
  for (std::size_t segment = 0; segment < bytes_of_scalar; ++segment) {
    const std::size_t begin = begin_of(segment), end = begin_of(segment + 1);
    if (begin < rle_header_bytes || begin > end || end > image.size())
      throw std::runtime_error("its run-length header is damaged");
    // The first segment has the most significant bytes.
    static_assert(std::endian::native == std::endian::little);
    unpack(image.subspan(begin, end - begin), bytes_of_scalar, scalars.subspan(bytes_of_scalar - 1 - segment));
  }
}

}  // namespace understudy::volume
