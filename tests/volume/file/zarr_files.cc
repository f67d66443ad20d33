// SPDX-License-Identifier: Apache-2.0
#include "tests/volume/file/zarr_files.h"

#include <blosc.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lz4.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace understudy::volume::testing {

Bytes packed(const Bytes& chunk, ChunkCodec codec, std::size_t scalar) {
  Bytes out(chunk.size() + chunk.size() / 2 + 1024);
  std::size_t bytes = 0;
  switch (codec) {
    case ChunkCodec::none:
      return chunk;
    case ChunkCodec::blosc:
      bytes = std::size_t(
          blosc_compress_ctx(5, 1, scalar, chunk.size(), chunk.data(), out.data(), out.size(), "lz4", 0, 1));
      break;
    case ChunkCodec::zlib:
      return gzipped(chunk);
    case ChunkCodec::zstd:
      bytes = ZSTD_compress(out.data(), out.size(), chunk.data(), chunk.size(), 3);
      break;
    case ChunkCodec::lz4: {
      const auto size = std::uint32_t(chunk.size());
      std::memcpy(out.data(), &size, 4);
      bytes = 4 + std::size_t(LZ4_compress_default(reinterpret_cast<const char*>(chunk.data()),
                                                   reinterpret_cast<char*>(out.data()) + 4, int(chunk.size()),
                                                   int(out.size() - 4)));
      break;
    }
  }
  out.resize(bytes);
  return out;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
  write_text(path, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

float half_by_definition(std::uint16_t bits) {
  const bool negative = (bits & 0x8000) != 0;
  const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
  if (exponent == 31 && fraction != 0)
    return std::bit_cast<float>((negative ? 0xff800000U : 0x7f800000U) | std::uint32_t(fraction) << 13);
  const double magnitude = exponent == 31  ? std::numeric_limits<double>::infinity()
                           : exponent == 0 ? std::ldexp(fraction, -24)
                                           : std::ldexp(1024 + fraction, exponent - 25);
  return float(std::copysign(magnitude, negative ? -1.0 : 1.0));
}

Bytes read_as_booleans(const Bytes& elements) {
  Bytes read;
  for (const std::byte element : elements)
    read.push_back(element == std::byte{0} ? std::byte{0} : std::byte{1});
  return read;
}

Bytes read_as_halves(const Bytes& elements) {
  std::vector<float> read;
  for (std::size_t i = 0; i + 1 < elements.size(); i += 2)
    read.push_back(half_by_definition(std::uint16_t(unsigned(elements[i]) | unsigned(elements[i + 1]) << 8)));
  return bytes_of(read);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

Bytes chunk_of(const Bytes& scalars, const std::array<int, 3>& low, const ZarrChoice& choice) {
  const std::size_t scalar = bytes_per_scalar(choice.type);
  Bytes chunk(std::size_t(chunk_size[0] * chunk_size[1] * chunk_size[2]) * scalar);
  std::size_t at = 0;
  const auto put = [&](int x, int y, int z) {
    const std::array<int, 3> place{low[0] + x, low[1] + y, low[2] + z};
    if (place[0] < array_size[0] && place[1] < array_size[1] && place[2] < array_size[2]) {
      const std::size_t from = (std::size_t(place[2] * array_size[1] + place[1]) * std::size_t(array_size[0]) +
                                std::size_t(place[0])) *
                               scalar;
      std::copy_n(scalars.begin() + std::ptrdiff_t(from), scalar, chunk.begin() + std::ptrdiff_t(at));
    }
    at += scalar;
  };
  if (choice.first_axis_fastest) {
    for (int x = 0; x < chunk_size[0]; ++x)
      for (int y = 0; y < chunk_size[1]; ++y)
        for (int z = 0; z < chunk_size[2]; ++z) put(x, y, z);
  } else {
    for (int z = 0; z < chunk_size[2]; ++z)
      for (int y = 0; y < chunk_size[1]; ++y)
        for (int x = 0; x < chunk_size[0]; ++x) put(x, y, z);
  }
  return choice.big_endian ? swapped(chunk, scalar) : chunk;
}

void read_with_damage(const TemporaryFolder& folder, const std::string& name, const std::string& volume,
                      int times, std::mt19937& random, Survival& survival) {
  const Bytes good = folder.read(name);
  for (int i = 0; i < times; ++i) {
    folder.write(name, damaged(good, random));
    const std::string trouble = trouble_with(folder.file(volume));
    ++(trouble.empty() ? survival.read : survival.refused);
    if (!trouble.empty()) {
      EXPECT_THAT(trouble, ::testing::HasSubstr(folder.file(volume)));
    }
  }
  folder.write(name, good);
}

}  // namespace understudy::volume::testing
