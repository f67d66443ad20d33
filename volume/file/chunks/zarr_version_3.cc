// SPDX-License-Identifier: Apache-2.0
#include "volume/file/chunks/zarr_version_3.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include "volume/file/chunks/zarr_json.h"

namespace understudy::volume {

namespace {

using nlohmann::json;

/// A codec, a chunk grid or a chunk key encoding: its name, optionally with its configuration.
struct Extension {
  std::string name;
  json configuration = json::object();
};

Extension extension_of(const json& entry) {
  if (entry.is_string()) return {entry.get<std::string>()};
  return {entry.at("name").get<std::string>(), entry.value("configuration", json::object())};
}

std::vector<Extension> extensions_of(const json& entries) {
  std::vector<Extension> extensions;
  for (const json& entry : entries) extensions.push_back(extension_of(entry));
  return extensions;
}

ElementType element_of(const json& data_type, const std::string& path) {
  static const std::map<std::string, ElementType> names{
      {"uint8", {ScalarType::u8}},    {"int8", {ScalarType::i8}},    {"uint16", {ScalarType::u16}},
      {"int16", {ScalarType::i16}},   {"uint32", {ScalarType::u32}}, {"int32", {ScalarType::i32}},
      {"uint64", {ScalarType::u64}},  {"int64", {ScalarType::i64}},  {"float32", {ScalarType::f32}},
      {"float64", {ScalarType::f64}}, {"bool", boolean_element},     {"float16", half_element}};
  const std::string name = extension_of(data_type).name;
  const auto found = names.find(name);
  if (found == names.end())
    fail_zarr(path,
              fmt::format("elements of type {} are no scalars that can be drawn; convert them first", name));
  return found->second;
}

std::vector<std::int64_t> chunk_lengths_of(const json& grid, const std::string& path) {
  const Extension extension = extension_of(grid);
  if (extension.name != "regular")
    fail_zarr(path, fmt::format("its chunks lie in a grid of kind '{}'; write a regular one", extension.name));
  return zarr_lengths(extension.configuration.at("chunk_shape"), path);
}

ChunkNames chunk_names_of(const json& encoding, const std::string& path) {
  const Extension extension = extension_of(encoding);
  if (extension.name != "default" && extension.name != "v2")
    fail_zarr(path, fmt::format("its chunks are named in the way '{}'; write them with the default one",
                                extension.name));
  const bool as_in_version_2 = extension.name == "v2";
  const auto separator = extension.configuration.value("separator", as_in_version_2 ? "." : "/");
  if (separator != "." && separator != "/")
    fail_zarr(path, fmt::format("'{}' between the numbers of a chunk is neither '.' nor '/'", separator));
  return {as_in_version_2 ? "" : "c" + separator, separator.front()};
}

/// The axis order of a chunk after transposing one with axes in `order`.
std::vector<std::size_t> transposed(const std::vector<std::size_t>& order, const json& permutation,
                                    const std::string& path) {
  // Drafts of the format used NumPy's orders.
  if (permutation == "C") return order;
  if (permutation == "F") return {order.rbegin(), order.rend()};
  const std::vector<std::int64_t> places = zarr_lengths(permutation, path);
  std::vector<std::int64_t> sorted = places;
  std::ranges::sort(sorted);
  std::vector<std::int64_t> all(order.size());
  std::iota(all.begin(), all.end(), std::int64_t(0));
  if (sorted != all)
    fail_zarr(path, "a transposition of its chunks is no permutation of the axes; get it again");
  std::vector<std::size_t> turned;
  turned.reserve(places.size());
  for (const std::int64_t place : places) turned.push_back(order[std::size_t(place)]);
  return turned;
}

/// Whether scalars are stored big-endian; single-byte scalars need not specify it.
bool is_big_endian(const json& configuration, std::size_t bytes, const std::string& path) {
  const json endian = configuration.value("endian", json());
  if (endian.is_null() && bytes == 1) return false;
  if (endian != "little" && endian != "big")
    fail_zarr(path,
              fmt::format("its byte order is {}, neither little nor big; get it again", zarr_text(endian)));
  return endian == "big";
}

/// Codecs of other programs are prefixed with the name of numcodecs.
std::string compressor_named(const std::string& name) {
  constexpr std::string_view registry = "numcodecs.";
  return name.starts_with(registry) ? name.substr(registry.size()) : name;
}

/// Reads codecs in the order in which they are applied: transpositions, then bytes, then compressors.
ChunkEncoding encoding_of(const json& codecs, std::size_t axes, std::size_t element_bytes,
                          const std::string& path) {
  ChunkEncoding encoding;
  encoding.order.resize(axes);
  std::iota(encoding.order.begin(), encoding.order.end(), std::size_t(0));
  bool are_bytes = false;
  for (const Extension& codec : extensions_of(codecs)) {
    const auto fail = [&](const char* why) {
      fail_zarr(path, fmt::format("its codec '{}' {}", codec.name, why));
    };
    if (codec.name == "sharding_indexed") fail("is not alone, or lies in another; write chunks without it");
    if (encoding.checksum) fail("comes behind a checksum; write the checksum last");
    const bool makes_bytes = codec.name == "transpose" || codec.name == "bytes";
    if (makes_bytes && are_bytes) fail("comes behind one that made bytes of the elements; get it again");
    if (!makes_bytes && !are_bytes)
      fail(
          "is not read before its elements are bytes; write chunks by bytes, and blosc, zstd or gzip behind "
          "it");
    if (codec.name == "transpose") {
      encoding.order = transposed(encoding.order, codec.configuration.at("order"), path);
    } else if (codec.name == "bytes") {
      encoding.big_endian = is_big_endian(codec.configuration, element_bytes, path);
      are_bytes = true;
    } else if (codec.name == "crc32c" || codec.name == "numcodecs.crc32c") {
      encoding.checksum = true;
    } else {
      if (encoding.codec != ChunkCodec::none)
        fail("compresses what is compressed already; write chunks with one");
      encoding.codec = zarr_codec(compressor_named(codec.name), path);
    }
  }
  if (!are_bytes) fail_zarr(path, "no codec makes bytes of its elements; get it again");
  return encoding;
}

Shards shards_of(const json& configuration, const std::string& path) {
  Shards shards;
  const auto place = configuration.value("index_location", "end");
  if (place != "start" && place != "end")
    fail_zarr(path, fmt::format("the index of its shards is at '{}', neither start nor end", place));
  shards.index_in_front = place == "start";
  const ChunkEncoding index = encoding_of(configuration.at("index_codecs"), 0, sizeof(std::uint64_t), path);
  if (index.codec != ChunkCodec::none)
    fail_zarr(path, "the index of its shards is compressed; write it plainly");
  shards.index_big_endian = index.big_endian;
  shards.index_checksum = index.checksum;
  return shards;
}

void read_codecs(const json& codecs, ZarrArray& array, const std::string& path) {
  const std::size_t axes = array.shape.size(), element_bytes = stored_bytes(array.element);
  const bool in_shards = codecs.size() == 1 && extension_of(codecs.at(0)).name == "sharding_indexed";
  if (!in_shards) {
    array.encoding = encoding_of(codecs, axes, element_bytes, path);
    return;
  }
  const json configuration = extension_of(codecs.at(0)).configuration;
  array.shards = shards_of(configuration, path);
  array.encoding = encoding_of(configuration.at("codecs"), axes, element_bytes, path);
  const std::vector<std::int64_t> lengths =
      std::exchange(array.chunks, zarr_lengths(configuration.at("chunk_shape"), path));
  for (std::size_t axis = 0; axis < lengths.size(); ++axis) {
    const std::int64_t chunk = axis < array.chunks.size() ? array.chunks[axis] : 0;
    if (chunk < 1 || lengths[axis] % chunk != 0)
      fail_zarr(path, fmt::format(
                          "{} elements of a shard along axis {} are no multiple of {} of a chunk; get it again",
                          lengths[axis], axis, chunk));
    array.shards->chunks.push_back(lengths[axis] / chunk);
  }
}

/// An unknown extension changes the meaning of the array unless it declares that it does not.
void check_names(const json& metadata, const std::string& path) {
  static constexpr std::array known{
      "zarr_format",        "node_type",  "shape",  "data_type",  "chunk_grid",
      "chunk_key_encoding", "fill_value", "codecs", "attributes", "storage_transformers",
      "dimension_names"};
  for (const auto& [name, value] : metadata.items()) {
    const bool matters = !value.is_object() || value.value("must_understand", true);
    if (std::ranges::find(known, std::string_view(name)) == known.end() && matters)
      fail_zarr(path, fmt::format("it says '{}', which is not known here; write it without", name));
  }
  if (metadata.contains("storage_transformers") && !metadata.at("storage_transformers").empty())
    fail_zarr(path, "it has storage transformers; write it without");
}

}  // namespace

ZarrArray array_of_version_3(const json& metadata, const std::string& path) {
  if (metadata.at("zarr_format") != 3)
    fail_zarr(path, fmt::format("it is of version {}; versions 2 and 3 are read",
                                zarr_text(metadata.at("zarr_format"))));
  if (metadata.at("node_type") != "array") fail_zarr(path, "it is no array; give one of those in it");
  check_names(metadata, path);
  ZarrArray array;
  array.shape = zarr_lengths(metadata.at("shape"), path);
  array.element = element_of(metadata.at("data_type"), path);
  array.chunks = chunk_lengths_of(metadata.at("chunk_grid"), path);
  if (array.shape.size() > most_zarr_axes)
    fail_zarr(path, fmt::format("it has {} axes; up to {} are read", array.shape.size(), most_zarr_axes));
  array.names = chunk_names_of(metadata.at("chunk_key_encoding"), path);
  array.fill = zarr_fill_value(metadata.at("fill_value"), array.element, path);
  read_codecs(metadata.at("codecs"), array, path);
  return array;
}

}  // namespace understudy::volume
