// SPDX-License-Identifier: Apache-2.0
// Chunks as programs that write Zarr leave them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <random>
#include <string>

#include "tests/volume/file/volume_files.h"
#include "volume/file/chunks/chunk_codec.h"

namespace understudy::volume::testing {

inline constexpr std::array<int, 3> array_size{37, 21, 11}, chunk_size{16, 8, 4};

struct ZarrChoice {
  ScalarType type = ScalarType::u16;
  ChunkCodec codec = ChunkCodec::none;
  bool big_endian = false;
  bool first_axis_fastest = false;
  char separator = '.';
};

Bytes packed(const Bytes& chunk, ChunkCodec codec, std::size_t scalar);

void write_text(const std::filesystem::path& path, const std::string& text);
void write_bytes(const std::filesystem::path& path, const Bytes& bytes);

/// How often a volume is read, and how often refused, whose files have changed bytes.
struct Survival {
  int read = 0, refused = 0;
};

/// `name` in `folder` is changed `times` times, and `volume` opened, which says where it is when it is refused.
void read_with_damage(const TemporaryFolder& folder, const std::string& name, const std::string& volume,
                      int times, std::mt19937& random, Survival& survival);

/// What IEEE 754 defines; NaNs keep their sign and the bits of their payload.
float half_by_definition(std::uint16_t bits);

/// Bytes of 0 and 1 of bytes that a program wrote as booleans, and floats of numbers of half precision.
Bytes read_as_booleans(const Bytes& elements);
Bytes read_as_halves(const Bytes& elements);

std::string replaced(std::string text, const std::string& from, const std::string& to);

/// The chunk's scalars, those outside of the array 0, in the order that was chosen.
Bytes chunk_of(const Bytes& scalars, const std::array<int, 3>& low, const ZarrChoice& choice);

}  // namespace understudy::volume::testing
