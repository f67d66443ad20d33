// SPDX-License-Identifier: Apache-2.0
// Element types of Zarr arrays that other formats do not have: they are converted to scalars of another type.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "volume/file/scalar_type.h"

namespace understudy::volume {

/// How an array stores its elements: as scalars of their type, as booleans of one byte, or as half-precision
/// floats (IEEE 754 binary16).
enum class Storage : std::uint8_t { scalar, boolean, half };

/// Storage of elements, and the type they are converted to: u8 (0 or 1) for booleans, f32 for halves.
struct ElementType {
  ScalarType type = ScalarType::u8;
  Storage storage = Storage::scalar;
};

constexpr ElementType boolean_element{ScalarType::u8, Storage::boolean};
constexpr ElementType half_element{ScalarType::f32, Storage::half};

std::size_t stored_bytes(const ElementType& element);

/// Exact: every half is representable as a float. NaNs keep the upper bits of their payload.
float float_of_half(std::uint16_t bits);

/// Fills `scalars` from elements in this processor's byte order. Not for Storage::scalar, where both are the
/// same.
void convert_elements(Storage storage, std::span<const std::byte> elements, std::span<std::byte> scalars);

}  // namespace understudy::volume
