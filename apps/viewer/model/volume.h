// SPDX-License-Identifier: Apache-2.0
// A scalar volume as stored in a file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/viewer/model/vector_math.h"

namespace viewer {

enum class ScalarType { u8, i8, u16, i16, f32 };

/// "u8", "i8", "u16", "i16" or "f32".
std::string_view name_of(ScalarType type);
std::optional<ScalarType> scalar_type_named(std::string_view name);
std::size_t bytes_per_voxel(ScalarType type);

using VolumeSize = std::array<std::int64_t, 3>;

/// Volumes with longer edges or more bytes are rejected: no 3-D texture could hold them.
inline constexpr std::int64_t max_edge_voxels = 1 << 16;
inline constexpr std::int64_t max_volume_bytes = std::int64_t{1} << 38;

/// Valid distances between voxels, from atoms to galaxies; beyond this range, squares overflow.
inline constexpr double min_spacing = 1e-30;
inline constexpr double max_spacing = 1e30;

struct Volume {
  std::string file;
  VolumeSize size{};      ///< voxels along x, y, z
  Vec3 spacing{1, 1, 1};  ///< distance between voxel centres, any unit
  ScalarType type = ScalarType::u8;
  std::vector<std::byte> voxels;  ///< x fastest, byte order of this machine
};

/// For example "256x256x110".
std::string text_of(const VolumeSize& size);

/// Returns the bytes of a volume. Throws Error if an edge is below 1 or a limit above is
/// exceeded; `where` names the file.
std::int64_t volume_bytes(const VolumeSize& size, ScalarType type, const std::string& where);

}  // namespace viewer
