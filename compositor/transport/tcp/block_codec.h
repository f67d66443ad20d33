// SPDX-License-Identifier: Apache-2.0
// Compresses blocks of a message without loss, and chooses the codec that is fastest over a connection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

struct ZSTD_CCtx_s;

namespace understudy::compositor {

enum class Codec : std::uint8_t { none, lz4, zstd, last = zstd };
constexpr std::size_t codec_count = std::size_t(Codec::last) + 1;

class BlockCompressor {
 public:
  BlockCompressor();
  ~BlockCompressor();
  BlockCompressor(const BlockCompressor&) = delete;
  BlockCompressor& operator=(const BlockCompressor&) = delete;

  /// Compresses `from`, of at most limits::max_tcp_block_bytes, into `to`. Returns false, with `to` in any
  /// state, if the result would not be shorter.
  bool compress(Codec codec, std::span<const std::byte> from, std::vector<std::byte>& to);

 private:
  ZSTD_CCtx_s* zstd_;  ///< kept, so that its memory is reused from block to block
};

/// `to` has as many bytes as were compressed. Throws MalformedMessage if `from` decompresses to anything else.
void decompress(Codec codec, std::span<const std::byte> from, std::span<std::byte> to);

/// Chooses the codec with which a byte arrives soonest, by each codec's speed and compression ratio for the
/// last blocks of this kind, and by the speed of the connection.
class CodecChoice {
 public:
  Codec best(double line_bytes_per_second) const;
  /// Records a measurement. A codec not used for long gets its optimistic initial figures again.
  void note(Codec codec, std::size_t bytes, std::size_t compressed_bytes, double seconds);

 private:
  struct Figures {
    double seconds_per_byte = 0;  ///< to compress and to decompress
    double ratio = 1;             ///< bytes sent for one byte
  };
  static constexpr std::array<Figures, codec_count> hoped_for = {{{0, 1}, {2e-9, 0.5}, {5e-9, 0.35}}};
  std::array<Figures, codec_count> measured_ = hoped_for;
  std::array<int, codec_count> untried_{};  ///< how many blocks ago each was used last
};

}  // namespace understudy::compositor
