// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/chunk_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

constexpr std::size_t index_entry_bytes = 16;

void reverse_bytes(std::span<std::byte> scalars, std::size_t bytes) {
  for (std::size_t at = 0; at < scalars.size(); at += bytes)
    std::reverse(scalars.begin() + std::ptrdiff_t(at), scalars.begin() + std::ptrdiff_t(at + bytes));
}

std::uint64_t number_at(std::span<const std::byte> bytes, std::size_t at, bool big_endian) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < sizeof number; ++i)
    number |= std::uint64_t(bytes[at + (big_endian ? sizeof number - 1 - i : i)]) << (8 * i);
  return number;
}

}  // namespace

ChunkFiles::ChunkFiles(std::string folder, ZarrArray array, ReadableFiles files)
    : folder_(std::move(folder)), array_(std::move(array)), files_(std::move(files)) {
  std::size_t elements = 1;
  for (const std::int64_t length : array_.chunks) elements *= std::size_t(length);
  decoded_bytes_ = elements * bytes_per_scalar(array_.element.type);
  stored_bytes_ = elements * stored_bytes(array_.element);
}

std::vector<std::byte> ChunkFiles::scalars_of(std::span<const std::int64_t> chunk) {
  const std::optional<std::vector<std::byte>> bytes = array_.shards ? packed_in_shard(chunk) : packed(chunk);
  if (!bytes) {
    std::vector<std::byte> scalars(decoded_bytes_);
    for (std::size_t at = 0; at < scalars.size(); at += array_.fill.size())
      std::ranges::copy(array_.fill, scalars.begin() + std::ptrdiff_t(at));
    return scalars;
  }
  std::vector<std::byte> elements(stored_bytes_);
  try {
    std::span<const std::byte> checked = *bytes;
    if (array_.encoding.checksum) checked = without_checksum(checked);
    decode_chunk(array_.encoding.codec, checked, elements);
  } catch (const std::runtime_error& error) {
    throw FileError(fmt::format("{}: Zarr: {}; get the file again", path_of(chunk), error.what()));
  }
  if (array_.encoding.big_endian != (std::endian::native == std::endian::big))
    reverse_bytes(elements, stored_bytes(array_.element));
  if (array_.element.storage == Storage::scalar) return elements;
  std::vector<std::byte> scalars(decoded_bytes_);
  convert_elements(array_.element.storage, elements, scalars);
  return scalars;
}

std::size_t ChunkFiles::memory_to_read(std::size_t shards) const {
  // Plus one index in the form in which it is stored in the file.
  const std::size_t indices = array_.shards ? shards + 1 : 0;
  const std::size_t unconverted = array_.element.storage == Storage::scalar ? 0 : stored_bytes_;
  return most_packed_bytes() + unconverted + indices * chunks_in_shard() * index_entry_bytes;
}

std::string ChunkFiles::path_of(std::span<const std::int64_t> chunk) const {
  std::string name;
  for (std::size_t axis = 0; axis < chunk.size(); ++axis) {
    if (axis > 0) name += array_.names.separator;
    name += std::to_string(array_.shards ? chunk[axis] / array_.shards->chunks[axis] : chunk[axis]);
  }
  return (std::filesystem::path(folder_) / (array_.names.prefix + name)).string();
}

std::optional<std::vector<std::byte>> ChunkFiles::packed(std::span<const std::int64_t> chunk) {
  const std::unique_ptr<ByteSource> file = open_file_if_there(path_of(chunk), files_);
  if (!file) return std::nullopt;
  return read_bytes(*file, {0, file->size().value_or(0)});
}

std::optional<std::vector<std::byte>> ChunkFiles::packed_in_shard(std::span<const std::int64_t> chunk) {
  const std::unique_ptr<ByteSource> file = open_file_if_there(path_of(chunk), files_);
  if (!file) return std::nullopt;
  std::vector<std::int64_t> shard;
  std::size_t number = 0;
  for (std::size_t axis = 0; axis < chunk.size(); ++axis) {
    const std::int64_t count = array_.shards->chunks[axis];
    shard.push_back(chunk[axis] / count);
    number = number * std::size_t(count) + std::size_t(chunk[axis] % count);
  }
  const Place place = index_of(shard, *file)[number];
  if (place == not_there) return std::nullopt;
  return read_bytes(*file, place);
}

const ChunkFiles::ShardIndex& ChunkFiles::index_of(const std::vector<std::int64_t>& shard, ByteSource& file) {
  const auto found = indices_.find(shard);
  if (found != indices_.end()) return found->second;
  return indices_.emplace(shard, read_index(file)).first->second;
}

ChunkFiles::ShardIndex ChunkFiles::read_index(ByteSource& file) {
  const Shards& shards = *array_.shards;
  const std::size_t entries = chunks_in_shard();
  std::vector<std::byte> bytes(entries * index_entry_bytes + (shards.index_checksum ? checksum_bytes : 0));
  const std::uint64_t size = file.size().value_or(0);
  const auto fail = [&](const char* why) {
    throw FileError(fmt::format("{}: Zarr: {}; get the file again", file.path(), why));
  };
  if (size < bytes.size()) fail("it is too short for the index of its chunks");
  if (file.read(shards.index_in_front ? 0 : size - bytes.size(), bytes) != bytes.size())
    fail("it ends in the index of its chunks");
  bytes_read_ += bytes.size();
  std::span<const std::byte> checked = bytes;
  try {
    if (shards.index_checksum) checked = without_checksum(checked);
  } catch (const std::runtime_error&) {
    fail("the index of its chunks is damaged");
  }
  ShardIndex index(entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const Place place{
        number_at(checked, i * index_entry_bytes, shards.index_big_endian),
        number_at(checked, i * index_entry_bytes + sizeof(std::uint64_t), shards.index_big_endian)};
    if (place != not_there && (place.bytes > size || place.offset > size - place.bytes))
      fail("the index of its chunks leads beyond its end");
    index[i] = place;
  }
  return index;
}

std::vector<std::byte> ChunkFiles::read_bytes(ByteSource& file, Place place) {
  if (place.bytes > most_packed_bytes())
    throw FileError(fmt::format("{}: Zarr: a chunk of {} bytes has {}; get it again", file.path(),
                                stored_bytes_, place.bytes));
  std::vector<std::byte> bytes(static_cast<std::size_t>(place.bytes));
  bytes.resize(file.read(place.offset, bytes));
  bytes_read_ += bytes.size();
  return bytes;
}

/// Compressed data may be slightly longer than the original.
std::size_t ChunkFiles::most_packed_bytes() const {
  constexpr std::size_t most_overhead = std::size_t(1) << 16;
  return stored_bytes_ + stored_bytes_ / 2 + most_overhead;
}

std::size_t ChunkFiles::chunks_in_shard() const {
  std::size_t chunks = 1;
  if (!array_.shards) return chunks;
  for (const std::int64_t count : array_.shards->chunks) chunks *= std::size_t(count);
  return chunks;
}

}  // namespace understudy::volume
