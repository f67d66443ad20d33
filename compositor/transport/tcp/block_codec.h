// SPDX-License-Identifier: Apache-2.0
// Blocks of a message, compressed without loss or as they are, and which of it is the fastest way over a line.
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

  /// Compresses `from`, which is no longer than limits::max_tcp_block_bytes, into `to`. False, with `to` in
  /// any state, where it does not get shorter.
  bool compress(Codec codec, std::span<const std::byte> from, std::vector<std::byte>& to);

 private:
  ZSTD_CCtx_s* zstd_;  ///< its memory is kept from block to block
};

/// `to` has as many bytes as were compressed. Throws MalformedMessage when `from` says something else.
void decompress(Codec codec, std::span<const std::byte> from, std::span<std::byte> to);

/// Takes the codec with which a byte is at the other end soonest, by how fast each was, and how well it did, on
/// the last blocks of this kind, and by how fast the line is.
class CodecChoice {
 public:
  Codec best(double line_bytes_per_second) const;
  /// Of who has not been tried for long the best is hoped, so that he is tried again.
  void note(Codec codec, std::size_t bytes, std::size_t compressed_bytes, double seconds);

 private:
  struct Figures {
    double seconds_per_byte = 0;  ///< to compress, and to decompress
    double ratio = 1;             ///< bytes that travel for one byte
  };
  static constexpr std::array<Figures, codec_count> hoped_for = {{{0, 1}, {2e-9, 0.5}, {5e-9, 0.35}}};
  std::array<Figures, codec_count> measured_ = hoped_for;
  std::array<int, codec_count> untried_{};  ///< for so many blocks
};

}  // namespace understudy::compositor
