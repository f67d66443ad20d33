// SPDX-License-Identifier: Apache-2.0
// Scalar types of files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace understudy::volume {

enum class ScalarType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

std::size_t bytes_per_scalar(ScalarType type);

/// "u8", "i8", ... "f64".
std::string_view name_of(ScalarType type);

/// Accepts these names and the long ones: "uint8", "int16", "float32", "float64".
std::optional<ScalarType> scalar_type_named(std::string_view name);

}  // namespace understudy::volume
