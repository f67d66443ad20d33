// SPDX-License-Identifier: Apache-2.0
// Maps the scalar types that hierarchical volumes support to C++ types.
#pragma once

#include <cstdint>

#include "volume/file/scalar_type.h"

namespace understudy::volume {

/// Calls `visit` with a value of that type. Returns false for unsupported types: 64-bit integers.
template <typename Visit>
bool with_sample_type(ScalarType type, Visit&& visit) {
  switch (type) {
    case ScalarType::u8:
      return visit(std::uint8_t{}), true;
    case ScalarType::i8:
      return visit(std::int8_t{}), true;
    case ScalarType::u16:
      return visit(std::uint16_t{}), true;
    case ScalarType::i16:
      return visit(std::int16_t{}), true;
    case ScalarType::u32:
      return visit(std::uint32_t{}), true;
    case ScalarType::i32:
      return visit(std::int32_t{}), true;
    case ScalarType::f32:
      return visit(float{}), true;
    case ScalarType::f64:
      return visit(double{}), true;
    case ScalarType::u64:
    case ScalarType::i64:
      break;
  }
  return false;
}

}  // namespace understudy::volume
