// SPDX-License-Identifier: Apache-2.0
// Chunks in the form in which programs write Zarr.
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

/// How often a volume with changed bytes was read, and how often it was refused.
struct Survival {
  int read = 0, refused = 0;
};

/// Damages `name` in `folder` `times` times and reads `volume` each time; a refusal must name the volume's
/// path.
void read_with_damage(const TemporaryFolder& folder, const std::string& name, const std::string& volume,
                      int times, std::mt19937& random, Survival& survival);

/// Half-precision value by the definition of IEEE 754; NaNs keep their sign and their payload bits.
float half_by_definition(std::uint16_t bits);

/// Booleans as bytes of 0 and 1, and half-precision numbers as floats.
Bytes read_as_booleans(const Bytes& elements);
Bytes read_as_halves(const Bytes& elements);

std::string replaced(std::string text, const std::string& from, const std::string& to);

/// The chunk's scalars in the chosen order; elements outside the array are 0.
Bytes chunk_of(const Bytes& scalars, const std::array<int, 3>& low, const ZarrChoice& choice);

}  // namespace understudy::volume::testing
