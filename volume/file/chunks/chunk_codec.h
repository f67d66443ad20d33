// SPDX-License-Identifier: Apache-2.0
// Compression of chunks: the codecs of numcodecs that are supported by available libraries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace understudy::volume {

/// gzip and zlib differ only in their headers.
enum class ChunkCodec : std::uint8_t { none, blosc, zlib, zstd, lz4 };

/// Fills `chunk`. Throws std::runtime_error with the reason unless `packed` decodes to exactly its size.
void decode_chunk(ChunkCodec codec, std::span<const std::byte> packed, std::span<std::byte> chunk);

constexpr std::size_t checksum_bytes = 4;

/// Returns all but the last four bytes, which must be the CRC-32C of the others, little-endian. Throws
/// std::runtime_error if they are not.
std::span<const std::byte> without_checksum(std::span<const std::byte> bytes);

}  // namespace understudy::volume
