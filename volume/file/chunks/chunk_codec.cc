// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/chunk_codec.h"

#include <blosc.h>
#include <lz4.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <limits>
#include <stdexcept>

namespace understudy::volume {

namespace {

[[noreturn]] void fail_chunk() {
  throw std::runtime_error("its compressed bytes are damaged, or of another size");
}

void decode_blosc(std::span<const std::byte> packed, std::span<std::byte> chunk) {
  std::size_t bytes = 0;
  if (packed.size() < BLOSC_MIN_HEADER_LENGTH ||
      blosc_cbuffer_validate(packed.data(), packed.size(), &bytes) != 0 || bytes != chunk.size() ||
      blosc_decompress_ctx(packed.data(), chunk.data(), chunk.size(), 1) != int(chunk.size()))
    fail_chunk();
}

void decode_zlib(std::span<const std::byte> packed, std::span<std::byte> chunk) {
  constexpr int either_header = 32 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, either_header) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
  stream.avail_in = uInt(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
  stream.avail_out = uInt(chunk.size());
  const int ended = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (ended != Z_STREAM_END || stream.avail_out != 0) fail_chunk();
}

/// numcodecs prepends the decoded size, in four bytes.
void decode_lz4(std::span<const std::byte> packed, std::span<std::byte> chunk) {
  constexpr std::size_t size_bytes = 4;
  if (packed.size() < size_bytes) fail_chunk();
  const auto* const from = reinterpret_cast<const char*>(packed.data() + size_bytes);
  const int got = LZ4_decompress_safe(from, reinterpret_cast<char*>(chunk.data()),
                                      int(packed.size() - size_bytes), int(chunk.size()));
  if (got < 0 || std::size_t(got) != chunk.size()) fail_chunk();
}

}  // namespace

void decode_chunk(ChunkCodec codec, std::span<const std::byte> packed, std::span<std::byte> chunk) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (packed.size() > most || chunk.size() > most) throw std::runtime_error("it has 2 GiB or more");
  switch (codec) {
    case ChunkCodec::none:
      if (packed.size() != chunk.size()) fail_chunk();
      std::ranges::copy(packed, chunk.begin());
      return;
    case ChunkCodec::blosc:
      return decode_blosc(packed, chunk);
    case ChunkCodec::zlib:
      return decode_zlib(packed, chunk);
    case ChunkCodec::zstd:
      if (ZSTD_decompress(chunk.data(), chunk.size(), packed.data(), packed.size()) != chunk.size())
        fail_chunk();
      return;
    case ChunkCodec::lz4:
      return decode_lz4(packed, chunk);
  }
}

std::span<const std::byte> without_checksum(std::span<const std::byte> bytes) {
  using Crc32c = boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true>;
  if (bytes.size() < checksum_bytes) fail_chunk();
  const std::span<const std::byte> checked = bytes.first(bytes.size() - checksum_bytes);
  Crc32c checksum;
  checksum.process_bytes(checked.data(), checked.size());
  std::uint32_t told = 0;
  for (std::size_t i = 0; i < checksum_bytes; ++i) told |= std::uint32_t(bytes[checked.size() + i]) << (8 * i);
  if (checksum.checksum() != told) throw std::runtime_error("its checksum is that of other bytes");
  return checked;
}

}  // namespace understudy::volume
