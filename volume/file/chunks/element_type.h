// SPDX-License-Identifier: Apache-2.0
// Elements of a Zarr array that no other format has: they are read as scalars of another type.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "volume/file/scalar_type.h"

namespace understudy::volume {

/// How an array stores its elements: as scalars of their type, as booleans of one byte, or as floats of half
/// precision (IEEE 754 binary16).
enum class Storage : std::uint8_t { scalar, boolean, half };

/// Elements as they are stored, and the type that they are read as: u8 (0 or 1) for booleans, f32 for halves.
struct ElementType {
  ScalarType type = ScalarType::u8;
  Storage storage = Storage::scalar;
};

constexpr ElementType boolean_element{ScalarType::u8, Storage::boolean};
constexpr ElementType half_element{ScalarType::f32, Storage::half};

std::size_t stored_bytes(const ElementType& element);

/// Exact: every half is a float. NaNs keep the upper bits of their payload.
float float_of_half(std::uint16_t bits);

/// Fills `scalars` from elements whose bytes are in this processor's order. Not for Storage::scalar, where both
/// are the same.
void convert_elements(Storage storage, std::span<const std::byte> elements, std::span<std::byte> scalars);

}  // namespace understudy::volume
