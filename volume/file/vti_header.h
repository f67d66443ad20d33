// SPDX-License-Identifier: Apache-2.0
// The XML header of a VTK image file, up to the beginning of its data.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "volume/file/byte_source.h"
#include "volume/file/scalar_type.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct VtiHeader {
  enum class Encoding : std::uint8_t { raw, base64 };

  std::array<std::int64_t, 3> size{};  ///< of the chosen array
  Vec3 spacing{1, 1, 1};
  ScalarType type = ScalarType::u8;
  bool big_endian = false;
  bool compressed = false;       ///< in zlib blocks
  std::size_t length_bytes = 4;  ///< of each number in front of the data
  Encoding encoding = Encoding::raw;
  std::uint64_t data_at = 0;  ///< where those numbers begin
};

/// Throws FileError.
VtiHeader read_vti_header(ByteSource& file);

}  // namespace understudy::volume
