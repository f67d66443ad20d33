// SPDX-License-Identifier: Apache-2.0
// Volumes to write to files, and checks of what is read back.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "tests/apps/viewer/temporary_folder.h"
#include "volume/file/file_error.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"
#include "volume/texel_box.h"

namespace understudy::volume::testing {

using viewer_test::TemporaryFolder;
using Bytes = std::vector<std::byte>;

template <typename T>
Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline Bytes swapped(Bytes bytes, std::size_t scalar) {
  for (std::size_t at = 0; at < bytes.size(); at += scalar)
    std::reverse(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + scalar));
  return bytes;
}

inline Bytes gzipped(const Bytes& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  Bytes packed(deflateBound(&stream, bytes.size()) + 64);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = uInt(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline Bytes joined(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

inline Bytes text_bytes(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

/// Random scalars: all values of an integer type; floating-point values between -1000 and 1000.
inline Bytes random_scalars(const std::array<int, 3>& size, ScalarType type, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t count = std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]);
  if (type == ScalarType::f32 || type == ScalarType::f64) {
    std::uniform_real_distribution<double> uniform(-1000, 1000);
    if (type == ScalarType::f64) {
      std::vector<double> values(count);
      for (double& value : values) value = uniform(random);
      return bytes_of(values);
    }
    std::vector<float> values(count);
    for (float& value : values) value = float(uniform(random));
    return bytes_of(values);
  }
  Bytes bytes(count * bytes_per_scalar(type));
  for (std::byte& byte : bytes) byte = std::byte(random() & 0xFFU);
  return bytes;
}

inline FileHints at_step(int time_step) {
  FileHints hints;
  hints.time_step = time_step;
  return hints;
}

inline Bytes read_box(VolumeFile& file, const TexelBox& box) {
  Bytes bytes(texels_in(box) * bytes_per_scalar(file.description().type));
  file.read(box, bytes);
  return bytes;
}

inline TexelBox whole(const VolumeFile& file) {
  return {{0, 0, 0}, file.description().size};
}

/// `bytes` with up to three random changes, and sometimes truncated.
inline Bytes damaged(Bytes bytes, std::mt19937& random) {
  const int changes = 1 + int(random() % 3);
  for (int k = 0; k < changes; ++k) bytes[random() % bytes.size()] = std::byte(random() & 0xFFU);
  if (random() % 8 == 0) bytes.resize(random() % bytes.size());
  return bytes;
}

/// Reads everything, slice by slice. Returns the error message, or "" if there is none.
inline std::string trouble_with(const std::string& name, const FileHints& hints = {},
                                const ReadableFiles& files = {}) {
  try {
    const auto file = open_volume(name, hints, files);
    for (int z = 0; z < file->description().size[2]; ++z) {
      TexelBox box = whole(*file);
      box.low[2] = z;
      box.high[2] = z + 1;
      read_box(*file, box);
    }
    return {};
  } catch (const FileError& error) {
    return error.what();
  }
}

inline TexelBox random_box(const std::array<int, 3>& size, std::mt19937& random) {
  TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = int(random() % unsigned(size[k]));
    box.high[k] = box.low[k] + 1 + int(random() % unsigned(size[k] - box.low[k]));
  }
  return box;
}

}  // namespace understudy::volume::testing
