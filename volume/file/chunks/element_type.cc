// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/element_type.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace understudy::volume {

std::size_t stored_bytes(const ElementType& element) {
  return element.storage == Storage::half ? sizeof(std::uint16_t) : bytes_per_scalar(element.type);
}

float float_of_half(std::uint16_t bits) {
  const std::uint32_t sign = std::uint32_t(bits & 0x8000) << 16;
  const std::uint32_t exponent = (bits >> 10) & 0x1f, fraction = bits & 0x3ff;
  constexpr std::uint32_t infinite_half = 0x1f, infinite_float = 0xff, bias_difference = 127 - 15;
  if (exponent == 0) {
    constexpr float least_half = 0x1p-24F;
    const float magnitude = float(fraction) * least_half;
    return sign != 0 ? -magnitude : magnitude;
  }
  const std::uint32_t wider = exponent == infinite_half ? infinite_float : exponent + bias_difference;
  return std::bit_cast<float>(sign | wider << 23 | fraction << 13);
}

void convert_elements(Storage storage, std::span<const std::byte> elements, std::span<std::byte> scalars) {
  if (storage == Storage::boolean) {
    std::ranges::transform(elements, scalars.begin(), [](std::byte b) { return std::byte{b != std::byte{}}; });
    return;
  }
  for (std::size_t i = 0; i < elements.size() / sizeof(std::uint16_t); ++i) {
    std::uint16_t bits = 0;
    std::memcpy(&bits, &elements[i * sizeof bits], sizeof bits);
    const float scalar = float_of_half(bits);
    std::memcpy(&scalars[i * sizeof scalar], &scalar, sizeof scalar);
  }
}

}  // namespace understudy::volume
