// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_array.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "volume/file/chunks/zarr_json.h"
#include "volume/file/chunks/zarr_version_3.h"

namespace understudy::volume {

namespace {

using nlohmann::json;

constexpr std::int64_t most_chunks_in_a_shard = std::int64_t(1) << 20;

ElementType element_of_version_2(const json& dtype, const std::string& path) {
  static const std::map<std::string, ElementType> names{
      {"u1", {ScalarType::u8}},  {"i1", {ScalarType::i8}},  {"u2", {ScalarType::u16}},
      {"i2", {ScalarType::i16}}, {"u4", {ScalarType::u32}}, {"i4", {ScalarType::i32}},
      {"u8", {ScalarType::u64}}, {"i8", {ScalarType::i64}}, {"f4", {ScalarType::f32}},
      {"f8", {ScalarType::f64}}, {"b1", boolean_element},   {"f2", half_element}};
  const std::string text = dtype.is_string() ? dtype.get<std::string>() : "with fields";
  const auto found = names.find(text.size() == 3 ? text.substr(1) : "");
  if (found == names.end())
    fail_zarr(path,
              fmt::format("elements of type {} are no scalars that can be drawn; convert them first", text));
  return found->second;
}

ChunkCodec compressor_of_version_2(const json& compressor, const std::string& path) {
  return compressor.is_null() ? ChunkCodec::none : zarr_codec(compressor.at("id").get<std::string>(), path);
}

/// Older programs wrote nested folders without declaring them. The first ones may be missing if they are empty.
bool has_folders(const ZarrArray& array, const std::string& folder, const ReadableFiles& files) {
  constexpr std::int64_t most_looked_at = 4096;
  if (array.shape.size() < 2 || array.chunks.empty() || array.chunks[0] < 1) return false;
  for (std::int64_t i = 0; i < std::min(most_looked_at, array.shape[0] / array.chunks[0] + 1); ++i)
    if (files.is_folder(path_in(folder, std::to_string(i)))) return true;
  return false;
}

char separator_of_version_2(const json& read, const ZarrArray& array, const std::string& folder,
                            const std::string& path, const ReadableFiles& files) {
  const json told = read.value("dimension_separator", json());
  if (told.is_null()) return has_folders(array, folder, files) ? '/' : '.';
  if (told != "." && told != "/")
    fail_zarr(path, fmt::format("{} between the numbers of a chunk is neither '.' nor '/'", zarr_text(told)));
  return told.get<std::string>().front();
}

ZarrArray array_of_version_2(const json& read, const std::string& folder, const std::string& path,
                             const ReadableFiles& files) {
  ZarrArray array;
  array.shape = zarr_lengths(read.at("shape"), path);
  array.chunks = zarr_lengths(read.at("chunks"), path);
  array.element = element_of_version_2(read.at("dtype"), path);
  array.encoding.big_endian = read.at("dtype").get<std::string>().front() == '>';
  array.encoding.order.resize(array.shape.size());
  std::iota(array.encoding.order.begin(), array.encoding.order.end(), std::size_t(0));
  if (read.value("order", "C") == "F") std::ranges::reverse(array.encoding.order);
  array.names.separator = separator_of_version_2(read, array, folder, path, files);
  if (read.contains("filters") && !read.at("filters").is_null() && !read.at("filters").empty())
    fail_zarr(path, "its chunks went through filters; write them without");
  array.encoding.codec = compressor_of_version_2(read.at("compressor"), path);
  array.fill = zarr_fill_value(read.at("fill_value"), array.element, path);
  return array;
}

void check_lengths(const ZarrArray& array, const std::string& path) {
  constexpr std::int64_t longest = std::int64_t(1) << 20;
  if (array.shape.empty() || array.shape.size() > most_zarr_axes || array.chunks.size() != array.shape.size())
    fail_zarr(path, fmt::format("it has {} axes and chunks of {}; up to {} are read", array.shape.size(),
                                array.chunks.size(), most_zarr_axes));
  std::uint64_t bytes = bytes_per_scalar(array.element.type);
  for (std::size_t axis = 0; axis < array.shape.size(); ++axis) {
    if (array.shape[axis] < 1 || array.shape[axis] > longest || array.chunks[axis] < 1 ||
        array.chunks[axis] > longest)
      fail_zarr(path, fmt::format(
                          "it has {} elements along axis {}, in chunks of {}, not 1 to {}; check its metadata",
                          array.shape[axis], axis, array.chunks[axis], longest));
    bytes *= std::uint64_t(array.chunks[axis]);
    if (bytes > std::uint64_t(std::numeric_limits<int>::max()))
      fail_zarr(path, "its chunks have 2 GiB or more; write smaller ones");
  }
}

void check_shards(const Shards& shards, std::size_t axes, const std::string& path) {
  if (shards.chunks.size() != axes)
    fail_zarr(path,
              fmt::format("it has {} axes and shards of {}; check its metadata", axes, shards.chunks.size()));
  std::int64_t chunks = 1;
  for (const std::int64_t count : shards.chunks) {
    if (count < 1 || count > most_chunks_in_a_shard / chunks)
      fail_zarr(path,
                fmt::format("its shards have more than {} chunks; write larger ones", most_chunks_in_a_shard));
    chunks *= count;
  }
}

}  // namespace

ZarrArray zarr_array(const std::string& folder, const ReadableFiles& files) {
  const std::string path = path_in(folder, "zarr.json"), older = path_in(folder, ".zarray");
  return with_json(path, [&] {
    const json read = json_in(folder, "zarr.json", files);
    ZarrArray array;
    if (!read.is_null()) {
      array = array_of_version_3(read, path);
    } else {
      const json of_version_2 = json_in(folder, ".zarray", files);
      if (of_version_2.is_null()) fail_zarr(older, "there is no such file; get the volume again");
      array = with_json(older, [&] { return array_of_version_2(of_version_2, folder, older, files); });
    }
    check_lengths(array, read.is_null() ? older : path);
    if (array.shards) check_shards(*array.shards, array.shape.size(), path);
    return array;
  });
}

}  // namespace understudy::volume
