// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/volume.h"

#include <fmt/format.h>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

struct TypeEntry {
  ScalarType type;
  std::string_view name;
  std::size_t bytes;
};
constexpr TypeEntry types[] = {{ScalarType::u8, "u8", 1},
                               {ScalarType::i8, "i8", 1},
                               {ScalarType::u16, "u16", 2},
                               {ScalarType::i16, "i16", 2},
                               {ScalarType::f32, "f32", 4}};

const TypeEntry& entry_of(ScalarType type) {
  return types[static_cast<std::size_t>(type)];
}

}  // namespace

std::string_view name_of(ScalarType type) {
  return entry_of(type).name;
}

std::size_t bytes_per_voxel(ScalarType type) {
  return entry_of(type).bytes;
}

std::optional<ScalarType> scalar_type_named(std::string_view name) {
  for (const TypeEntry& entry : types)
    if (entry.name == name) return entry.type;
  return std::nullopt;
}

std::string text_of(const VolumeSize& size) {
  return fmt::format("{}x{}x{}", size[0], size[1], size[2]);
}

std::int64_t volume_bytes(const VolumeSize& size, ScalarType type, const std::string& where) {
  for (const std::int64_t edge : size) {
    if (edge < 1)
      throw Error(ExitCode::bad_file,
                  fmt::format("{}: the size {} contains no voxels; every edge must be at least 1 (check "
                              "--size, or the size in the file's name or header)",
                              where, text_of(size)));
    if (edge > max_edge_voxels)
      throw Error(ExitCode::bad_file, fmt::format("{}: the size {} has an edge above the limit of {} voxels; "
                                                  "check the size, or crop or downsample the volume",
                                                  where, text_of(size), max_edge_voxels));
  }
  // Three edges of at most 2^16 and 4 bytes stay below 2^50: no overflow.
  const std::int64_t bytes = size[0] * size[1] * size[2] * static_cast<std::int64_t>(bytes_per_voxel(type));
  if (bytes > max_volume_bytes)
    throw Error(
        ExitCode::bad_file,
        fmt::format("{}: {} {} voxels take {} bytes, above the limit of {}; crop or downsample the volume",
                    where, text_of(size), name_of(type), bytes, max_volume_bytes));
  return bytes;
}

}  // namespace viewer
