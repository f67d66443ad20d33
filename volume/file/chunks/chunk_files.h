// SPDX-License-Identifier: Apache-2.0
// The chunks of an array, each in a file of its own or several in a shard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/file/byte_source.h"
#include "volume/file/chunks/zarr_array.h"
#include "volume/file/readable_files.h"

namespace understudy::volume {

class ChunkFiles {
 public:
  /// `folder` is the array's folder.
  ChunkFiles(std::string folder, ZarrArray array, ReadableFiles files);

  const ZarrArray& array() const { return array_; }
  const std::string& folder() const { return folder_; }

  /// The scalars of a chunk, in the axis order of array().encoding and this processor's representation. `chunk`
  /// has the chunk's index along each axis of the array. Throws FileError.
  std::vector<std::byte> scalars_of(std::span<const std::int64_t> chunk);

  /// Bytes of one decoded chunk.
  std::size_t decoded_bytes() const { return decoded_bytes_; }
  /// Peak memory while chunks of `shards` shards are read, in bytes, in addition to the chunks themselves.
  std::size_t memory_to_read(std::size_t shards) const;
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  struct Place {
    std::uint64_t offset = 0, bytes = 0;  ///< in the file

    bool operator==(const Place&) const = default;
  };
  /// The index entry of a missing chunk.
  static constexpr Place not_there{~std::uint64_t{}, ~std::uint64_t{}};
  /// The places of a shard's chunks.
  using ShardIndex = std::vector<Place>;

  std::string path_of(std::span<const std::int64_t> file) const;
  /// Empty if the chunk does not exist.
  std::optional<std::vector<std::byte>> packed(std::span<const std::int64_t> chunk);
  std::optional<std::vector<std::byte>> packed_in_shard(std::span<const std::int64_t> chunk);
  const ShardIndex& index_of(const std::vector<std::int64_t>& shard, ByteSource& file);
  ShardIndex read_index(ByteSource& file);
  std::vector<std::byte> read_bytes(ByteSource& file, Place place);
  std::size_t most_packed_bytes() const;
  std::size_t chunks_in_shard() const;

  std::string folder_;
  ZarrArray array_;
  ReadableFiles files_;
  std::size_t decoded_bytes_ = 0;
  std::size_t stored_bytes_ = 0;  ///< of one decoded chunk, before its elements are converted
  /// Each index is read once and kept, because indices may be long.
  std::map<std::vector<std::int64_t>, ShardIndex> indices_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace understudy::volume
