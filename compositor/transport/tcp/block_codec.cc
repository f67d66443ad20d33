// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/block_codec.h"

#include <lz4.h>
#include <zstd.h>

#include <new>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

namespace {

constexpr int zstd_level = 1;
constexpr double newest_counts = 0.5;   ///< weight of the newest measurement
constexpr int tried_again_after = 200;  ///< blocks
/// Time to compress and decompress, relative to compression alone; the same for both codecs.
constexpr double there_and_back = 1.3;

}  // namespace

BlockCompressor::BlockCompressor() : zstd_(::ZSTD_createCCtx()) {
  if (zstd_ == nullptr) throw std::bad_alloc();
}

BlockCompressor::~BlockCompressor() {
  ::ZSTD_freeCCtx(zstd_);
}

bool BlockCompressor::compress(Codec codec, std::span<const std::byte> from, std::vector<std::byte>& to) {
  if (from.size() < 2) return false;
  to.resize(from.size() - 1);
  std::size_t bytes = 0;
  if (codec == Codec::lz4) {
    const int written =
        ::LZ4_compress_default(reinterpret_cast<const char*>(from.data()), reinterpret_cast<char*>(to.data()),
                               int(from.size()), int(to.size()));
    bytes = written > 0 ? std::size_t(written) : 0;
  } else if (codec == Codec::zstd) {
    const std::size_t written =
        ::ZSTD_compressCCtx(zstd_, to.data(), to.size(), from.data(), from.size(), zstd_level);
    bytes = ::ZSTD_isError(written) != 0 ? 0 : written;
  }
  to.resize(bytes);
  return bytes != 0;
}

void decompress(Codec codec, std::span<const std::byte> from, std::span<std::byte> to) {
  bool whole = false;
  if (codec == Codec::lz4) {
    whole =
        ::LZ4_decompress_safe(reinterpret_cast<const char*>(from.data()), reinterpret_cast<char*>(to.data()),
                              int(from.size()), int(to.size())) == int(to.size());
  } else if (codec == Codec::zstd) {
    whole = ::ZSTD_decompress(to.data(), to.size(), from.data(), from.size()) == to.size();
  }
  if (!whole) throw MalformedMessage("a block does not hold what it says");
}

Codec CodecChoice::best(double line_bytes_per_second) const {
  if (line_bytes_per_second <= 0) return Codec::none;
  Codec best = Codec::none;
  double least = 0;
  for (std::size_t i = 0; i < codec_count; ++i) {
    const double seconds = measured_[i].seconds_per_byte + measured_[i].ratio / line_bytes_per_second;
    if (i != 0 && seconds >= least) continue;
    least = seconds;
    best = Codec(i);
  }
  return best;
}

void CodecChoice::note(Codec codec, std::size_t bytes, std::size_t compressed_bytes, double seconds) {
  for (std::size_t i = 1; i < codec_count; ++i) {
    Figures& figures = measured_[i];
    if (Codec(i) == codec) {
      figures.seconds_per_byte +=
          newest_counts * (there_and_back * seconds / double(bytes) - figures.seconds_per_byte);
      figures.ratio += newest_counts * (double(compressed_bytes) / double(bytes) - figures.ratio);
      untried_[i] = 0;
    } else if (++untried_[i] == tried_again_after) {
      figures = hoped_for[i];
      untried_[i] = 0;
    }
  }
}

}  // namespace understudy::compositor
