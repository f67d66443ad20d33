// SPDX-License-Identifier: Apache-2.0
#include "volume/file/scalar_type.h"

#include <algorithm>
#include <array>

namespace understudy::volume {

namespace {

struct Row {
  ScalarType type;
  std::size_t bytes;
  std::string_view name;
  std::string_view long_name;
};

constexpr std::array<Row, 10> rows{{{ScalarType::u8, 1, "u8", "uint8"},
                                    {ScalarType::i8, 1, "i8", "int8"},
                                    {ScalarType::u16, 2, "u16", "uint16"},
                                    {ScalarType::i16, 2, "i16", "int16"},
                                    {ScalarType::u32, 4, "u32", "uint32"},
                                    {ScalarType::i32, 4, "i32", "int32"},
                                    {ScalarType::u64, 8, "u64", "uint64"},
                                    {ScalarType::i64, 8, "i64", "int64"},
                                    {ScalarType::f32, 4, "f32", "float32"},
                                    {ScalarType::f64, 8, "f64", "float64"}}};

}  // namespace

std::size_t bytes_per_scalar(ScalarType type) {
  return rows[std::size_t(type)].bytes;
}

std::string_view name_of(ScalarType type) {
  return rows[std::size_t(type)].name;
}

std::optional<ScalarType> scalar_type_named(std::string_view name) {
  const auto* const found =
      std::ranges::find_if(rows, [&](const Row& row) { return name == row.name || name == row.long_name; });
  return found == rows.end() ? std::nullopt : std::optional(found->type);
}

}  // namespace understudy::volume
