// SPDX-License-Identifier: Apache-2.0
// How chunks are compressed: the codecs of numcodecs that libraries here have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace understudy::volume {

/// gzip and zlib differ in their headers alone.
enum class ChunkCodec : std::uint8_t { none, blosc, zlib, zstd, lz4 };

/// Fills `chunk`. Throws std::runtime_error, which says why, unless `packed` decodes to exactly so many bytes.
void decode_chunk(ChunkCodec codec, std::span<const std::byte> packed, std::span<std::byte> chunk);

constexpr std::size_t checksum_bytes = 4;

/// All but the last four bytes, which are the CRC-32C of those before, little-endian. Throws std::runtime_error
/// where they are not.
std::span<const std::byte> without_checksum(std::span<const std::byte> bytes);

}  // namespace understudy::volume
