// SPDX-License-Identifier: Apache-2.0
// The metadata of a Zarr array, version 2 or 3: zarr-specs.readthedocs.io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volume/file/chunks/chunk_codec.h"
#include "volume/file/chunks/element_type.h"
#include "volume/file/readable_files.h"

namespace understudy::volume {

/// How the scalars of a chunk are encoded as bytes.
struct ChunkEncoding {
  std::vector<std::size_t> order;  ///< the array's axes in the order of a chunk, slowest first
  bool big_endian = false;
  ChunkCodec codec = ChunkCodec::none;
  bool checksum = false;  ///< CRC-32C in the last four bytes
};

/// The name of a chunk's file: `prefix`, then the chunk's indices, separated by `separator`.
struct ChunkNames {
  std::string prefix;
  char separator = '.';
};

/// Several chunks in one file, with an index of their places.
struct Shards {
  std::vector<std::int64_t> chunks;  ///< number of chunks along each axis
  bool index_in_front = false;
  bool index_big_endian = false;
  bool index_checksum = true;
};

/// An array of scalars; axes are listed slowest first, as in the format.
struct ZarrArray {
  std::vector<std::int64_t> shape;
  std::vector<std::int64_t> chunks;  ///< length of a chunk along each axis
  ElementType element;
  ChunkEncoding encoding;
  ChunkNames names;
  std::optional<Shards> shards;
  std::vector<std::byte> fill;  ///< the scalar that fills missing chunks, of type element.type
};

constexpr std::size_t most_zarr_axes = 5;

/// Throws FileError.
ZarrArray zarr_array(const std::string& folder, const ReadableFiles& files);

}  // namespace understudy::volume
