// SPDX-License-Identifier: Apache-2.0
// Zarr arrays of version 3: every type and codec, transposed chunks, shards, and images of OME-Zarr 0.5.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "tests/volume/file/volume_files.h"
#include "tests/volume/file/zarr_files.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume::testing {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// RFC 3720, bit by bit.
std::uint32_t crc32c(const Bytes& bytes) {
  std::uint32_t rest = ~std::uint32_t{};
  for (const std::byte byte : bytes) {
    rest ^= std::uint32_t(byte);
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ (rest & 1 ? 0x82F63B78u : 0u);
  }
  return ~rest;
}

Bytes with_checksum(Bytes bytes) {
  const std::uint32_t checksum = crc32c(bytes);
  for (int i = 0; i < 4; ++i) bytes.push_back(std::byte(checksum >> (8 * i)));
  return bytes;
}

void append_number(Bytes& bytes, std::uint64_t number) {
  for (int i = 0; i < 8; ++i) bytes.push_back(std::byte(number >> (8 * i)));
}

struct Version3 {
  ZarrChoice chunk;  ///< its separator stands between the indices of a file name
  bool checksum = false;
  bool names_of_version_2 = false;
};

std::string type_name(ScalarType type) {
  using enum ScalarType;
  const char* const kind = type == f32 || type == f64                                ? "float"
                           : type == i8 || type == i16 || type == i32 || type == i64 ? "int"
                                                                                     : "uint";
  return fmt::format("{}{}", kind, 8 * bytes_per_scalar(type));
}

std::string codecs_of(const Version3& choice) {
  std::string codecs = choice.chunk.first_axis_fastest
                           ? R"({"name": "transpose", "configuration": {"order": [2, 1, 0]}}, )"
                           : "";
  codecs += bytes_per_scalar(choice.chunk.type) == 1
                ? R"("bytes")"
                : fmt::format(R"({{"name": "bytes", "configuration": {{"endian": "{}"}}}})",
                              choice.chunk.big_endian ? "big" : "little");
  switch (choice.chunk.codec) {
    case ChunkCodec::none:
      break;
    case ChunkCodec::blosc:
      codecs += R"(, {"name": "blosc", "configuration": {"cname": "lz4", "clevel": 5, "shuffle": "shuffle"}})";
      break;
    case ChunkCodec::zlib:
      codecs += R"(, {"name": "gzip", "configuration": {"level": 5}})";
      break;
    case ChunkCodec::zstd:
      codecs += R"(, {"name": "zstd", "configuration": {"level": 0, "checksum": false}})";
      break;
    case ChunkCodec::lz4:
      codecs += R"(, {"name": "numcodecs.lz4", "configuration": {"acceleration": 1}})";
      break;
  }
  return codecs + (choice.checksum ? R"(, {"name": "crc32c"})" : "");
}

std::string numbers(const std::array<int, 3>& values) {
  return fmt::format("[{}, {}, {}]", values[2], values[1], values[0]);
}

std::string metadata(const Version3& choice, const std::array<int, 3>& in_file, const std::string& codecs,
                     const std::string& more = "") {
  return fmt::format(R"({{"zarr_format": 3, "node_type": "array", "shape": {}, "data_type": "{}", )"
                     R"("chunk_grid": {{"name": "regular", "configuration": {{"chunk_shape": {}}}}}, )"
                     R"("chunk_key_encoding": {{"name": "{}", "configuration": {{"separator": "{}"}}}}, )"
                     R"("fill_value": 0, "codecs": [{}]{}}})",
                     numbers(array_size), type_name(choice.chunk.type), numbers(in_file),
                     choice.names_of_version_2 ? "v2" : "default", choice.chunk.separator, codecs, more);
}

Bytes encoded_chunk(const Bytes& scalars, const std::array<int, 3>& number, const Version3& choice) {
  const std::array<int, 3> low{number[0] * chunk_size[0], number[1] * chunk_size[1], number[2] * chunk_size[2]};
  Bytes chunk =
      packed(chunk_of(scalars, low, choice.chunk), choice.chunk.codec, bytes_per_scalar(choice.chunk.type));
  return choice.checksum ? with_checksum(std::move(chunk)) : chunk;
}

std::string name_of(const std::array<int, 3>& number, const Version3& choice) {
  const char separator = choice.chunk.separator;
  return fmt::format("{}{}{}{}{}{}", choice.names_of_version_2 ? "" : fmt::format("c{}", separator), number[2],
                     separator, number[1], separator, number[0]);
}

constexpr std::array<int, 3> chunks_of_array{3, 3, 3};

template <typename Function>
void for_each(const std::array<int, 3>& counts, const Function& function) {
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x) function(std::array<int, 3>{x, y, z});
}

void write_array(const std::filesystem::path& folder, const Bytes& scalars, const Version3& choice,
                 const std::string& more = "") {
  write_text(folder / "zarr.json", metadata(choice, chunk_size, codecs_of(choice), more));
  for_each(chunks_of_array, [&](const std::array<int, 3>& number) {
    write_bytes(folder / name_of(number, choice), encoded_chunk(scalars, number, choice));
  });
}

constexpr std::array<int, 3> chunks_of_shard{2, 3, 1};

/// Chunk 1, 1, 1 is missing, as are chunks outside the array.
Bytes shard_of(const Bytes& scalars, const std::array<int, 3>& shard, const Version3& choice,
               bool index_in_front) {
  Bytes chunks, index;
  const std::uint64_t first = index_in_front ? 6 * 16 + 4 : 0;
  for_each(chunks_of_shard, [&](const std::array<int, 3>& within) {
    std::array<int, 3> number{};
    bool is_there = false;
    for (std::size_t k = 0; k < 3; ++k) {
      number[k] = shard[k] * chunks_of_shard[k] + within[k];
      is_there |= number[k] != 1;
    }
    for (std::size_t k = 0; k < 3; ++k) is_there &= number[k] < chunks_of_array[k];
    const Bytes chunk = is_there ? encoded_chunk(scalars, number, choice) : Bytes();
    append_number(index, is_there ? first + chunks.size() : std::numeric_limits<std::uint64_t>::max());
    append_number(index, is_there ? chunk.size() : std::numeric_limits<std::uint64_t>::max());
    chunks.insert(chunks.end(), chunk.begin(), chunk.end());
  });
  index = with_checksum(std::move(index));
  return index_in_front ? joined(index, chunks) : joined(chunks, index);
}

std::string sharding(const Version3& choice, const char* index_location, const std::string& chunk_shape) {
  return fmt::format(
      R"({{"name": "sharding_indexed", "configuration": {{"chunk_shape": {}, "codecs": [{}], )"
      R"("index_codecs": [{{"name": "bytes", "configuration": {{"endian": "little"}}}}, {{"name": "crc32c"}}], )"
      R"("index_location": "{}"}}}})",
      chunk_shape, codecs_of(choice), index_location);
}

constexpr std::array<int, 3> shard_size{32, 24, 4}, shards_of_array{2, 1, 3};

void write_shards(const std::filesystem::path& folder, const Bytes& scalars, const Version3& choice,
                  bool index_in_front) {
  write_text(
      folder / "zarr.json",
      metadata(choice, shard_size, sharding(choice, index_in_front ? "start" : "end", numbers(chunk_size))));
  for_each(shards_of_array, [&](const std::array<int, 3>& shard) {
    write_bytes(folder / name_of(shard, choice), shard_of(scalars, shard, choice, index_in_front));
  });
}

/// With zeros for the chunk that shard_of() omits.
Bytes without_missing_chunk(const Bytes& scalars, std::size_t bytes) {
  Bytes kept = scalars;
  for (int z = chunk_size[2]; z < 2 * chunk_size[2]; ++z)
    for (int y = chunk_size[1]; y < 2 * chunk_size[1]; ++y) {
      const std::size_t row = std::size_t(z * array_size[1] + y) * std::size_t(array_size[0]);
      std::fill_n(kept.begin() + std::ptrdiff_t((row + std::size_t(chunk_size[0])) * bytes),
                  std::size_t(chunk_size[0]) * bytes, std::byte{});
    }
  return kept;
}

void expect_boxes(VolumeFile& file, const Bytes& scalars, ScalarType type) {
  ASSERT_EQ(file.description().size, array_size);
  ASSERT_EQ(file.description().type, type);
  ASSERT_EQ(read_box(file, whole(file)), scalars);
  std::mt19937 random(3);
  for (int i = 0; i < 10; ++i) {
    const TexelBox box = random_box(array_size, random);
    Bytes expected(texels_in(box) * bytes_per_scalar(type));
    copy_texels(box, bytes_per_scalar(type), whole(file), scalars, box, expected);
    ASSERT_EQ(read_box(file, box), expected);
  }
}

TEST(ZarrVersion3, EveryTypeOrderAndCodecInChunksAndShards) {
  using enum ScalarType;
  for (const ScalarType type : {u8, i8, u16, i16, u32, i32, u64, i64, f32, f64})
    for (const ChunkCodec codec :
         {ChunkCodec::none, ChunkCodec::blosc, ChunkCodec::zlib, ChunkCodec::zstd, ChunkCodec::lz4})
      for (const bool other_way : {false, true}) {
        SCOPED_TRACE(fmt::format("{} {} {}", type_name(type), int(codec), other_way));
        const TemporaryFolder folder;
        const Version3 choice{
            {type, codec, other_way && bytes_per_scalar(type) > 1, other_way, other_way ? '.' : '/'},
            other_way,
            type == i16};
        const Bytes scalars = random_scalars(array_size, type, 1 + unsigned(type));
        write_array(folder.file("chunks"), scalars, choice);
        expect_boxes(*open_volume(folder.file("chunks")), scalars, type);
        write_shards(folder.file("shards"), scalars, choice, other_way);
        expect_boxes(*open_volume(folder.file("shards")),
                     without_missing_chunk(scalars, bytes_per_scalar(type)), type);
      }
}

TEST(ZarrVersion3, BooleansAreReadAsBytesAndHalvesAsFloats) {
  const auto write = [](const TemporaryFolder& folder, const Bytes& elements, const Version3& choice,
                        const std::string& type, const std::string& fill) {
    write_array(folder.file("a"), elements, choice);
    const std::string text = metadata(choice, chunk_size, codecs_of(choice));
    write_text(folder.file("a/zarr.json"), replaced(replaced(text, type_name(choice.chunk.type), type),
                                                    R"("fill_value": 0)", R"("fill_value": )" + fill));
  };
  for (const bool other_way : {false, true}) {
    const TemporaryFolder folder;
    const Version3 halves{{ScalarType::u16, ChunkCodec::zstd, other_way, other_way, '/'}, other_way};
    const Bytes elements = random_scalars(array_size, ScalarType::u16, 7);
    write(folder, elements, halves, "float16", "0.0");
    expect_boxes(*open_volume(folder.file("a")), read_as_halves(elements), ScalarType::f32);

    const Version3 booleans{{ScalarType::u8, ChunkCodec::blosc, false, other_way, '/'}, other_way};
    const Bytes truths = random_scalars(array_size, ScalarType::u8, 8);
    write(folder, truths, booleans, "bool", "false");
    expect_boxes(*open_volume(folder.file("a")), read_as_booleans(truths), ScalarType::u8);
  }
}

TEST(ZarrVersion3, AShardIsReadInPart) {
  const TemporaryFolder folder;
  const Version3 choice;
  write_shards(folder.file("a"), random_scalars(array_size, choice.chunk.type, 2), choice, false);
  const auto file = open_volume(folder.file("a"));
  read_box(*file, {{0, 0, 0}, {3, 3, 3}});
  constexpr std::uint64_t chunk = 16 * 8 * 4 * 2, index = 6 * 16 + 4;
  EXPECT_EQ(file->bytes_read(), chunk + index);
}

template <typename Scalar>
void expect_fill(ScalarType type, const char* fill, Scalar scalar, const char* element = nullptr) {
  SCOPED_TRACE(fill);
  const TemporaryFolder folder;
  const Version3 choice{{.type = type}};
  std::string text = metadata(choice, chunk_size, codecs_of(choice));
  if (element != nullptr) text = replaced(text, type_name(type), element);
  write_text(folder.file("a/zarr.json"),
             replaced(text, R"("fill_value": 0)", fmt::format(R"("fill_value": {})", fill)));
  const auto file = open_volume(folder.file("a"));
  EXPECT_EQ(read_box(*file, whole(*file)), bytes_of(std::vector<Scalar>(texels_in(whole(*file)), scalar)));
}

TEST(ZarrVersion3, FillValuesAreExact) {
  expect_fill(ScalarType::u64, "18446744073709551615", std::numeric_limits<std::uint64_t>::max());
  expect_fill(ScalarType::i64, "-9223372036854775808", std::numeric_limits<std::int64_t>::min());
  expect_fill(ScalarType::i64, "9007199254740993", std::int64_t(9007199254740993));
  expect_fill(ScalarType::i16, "-7.0", std::int16_t(-7));
  expect_fill(ScalarType::f32, R"("0x40490fdb")", std::bit_cast<float>(0x40490fdbu));
  expect_fill(ScalarType::f64, R"("-Infinity")", -std::numeric_limits<double>::infinity());
  expect_fill(ScalarType::u16, R"("0x3e00")", 1.5F, "float16");
  expect_fill(ScalarType::u16, "-0.25", -0.25F, "float16");
  expect_fill(ScalarType::u8, "true", std::uint8_t(1), "bool");
}

TEST(ZarrVersion3, DimensionsHaveTheNamesThatTheyAreGiven) {
  const TemporaryFolder folder;
  const Version3 choice;
  const Bytes scalars = random_scalars(array_size, choice.chunk.type, 2);
  write_array(folder.file("a"), scalars, choice, R"(, "dimension_names": ["t", "y", "x"])");
  const auto file = open_volume(folder.file("a"), at_step(4));
  EXPECT_EQ(file->description().time_steps, array_size[2]);
  Bytes expected(std::size_t(array_size[0] * array_size[1]) * 2);
  std::copy_n(scalars.begin() + 4 * std::ptrdiff_t(expected.size()), expected.size(), expected.begin());
  EXPECT_EQ(read_box(*file, whole(*file)), expected);
  write_array(folder.file("b"), scalars, choice, R"(, "dimension_names": [null, null, null])");
  expect_boxes(*open_volume(folder.file("b")), scalars, choice.chunk.type);
}

TEST(ZarrVersion3, OmeZarrIsWithinOneAttribute) {
  const TemporaryFolder folder;
  const Version3 choice;
  write_text(folder.file("a/zarr.json"), R"({"zarr_format": 3, "node_type": "group",
    "consolidated_metadata": {"kind": "inline", "must_understand": false, "metadata": {}},
    "attributes": {"ome": {"version": "0.5", "multiscales": [{"axes": [
      {"name": "z", "type": "space", "unit": "micrometer"}, {"name": "y", "type": "space", "unit": "micrometer"},
      {"name": "x", "type": "space", "unit": "micrometer"}], "datasets": [
      {"path": "s0", "coordinateTransformations": [{"type": "scale", "scale": [2, 0.5, 0.25]}]},
      {"path": "s1", "coordinateTransformations": [{"type": "scale", "scale": [4, 1, 0.5]}]}]}]}}})");
  for (const int level : {0, 1}) {
    const Bytes scalars = random_scalars(array_size, choice.chunk.type, unsigned(7 + level));
    write_shards(folder.file(fmt::format("a/s{}", level)), scalars, choice, false);
    FileHints hints;
    hints.level = level;
    const auto file = open_volume(folder.file("a"), hints);
    EXPECT_THAT(file->description().spacing,
                ElementsAre(DoubleNear(0.25 * (1 + level), 1e-9), DoubleNear(0.5 * (1 + level), 1e-9),
                            DoubleNear(2 * (1 + level), 1e-9)));
    EXPECT_EQ(read_box(*file, whole(*file)), without_missing_chunk(scalars, 2));
  }
  EXPECT_THAT(trouble_with(folder.file("a/s1")), HasSubstr("it is a level of the image"));
}

TEST(ZarrVersion3, WhatIsNotReadSaysWhy) {
  const TemporaryFolder folder;
  const std::string name = folder.file("a");
  const Version3 choice;
  const std::string plain = metadata(choice, chunk_size, codecs_of(choice));
  const auto with = [&](const std::string& text) {
    write_text(name + "/zarr.json", text);
    return trouble_with(name);
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = plain;
    return with(text.replace(text.find(from), from.size(), to));
  };
  const auto with_codecs = [&](const std::string& codecs) {
    return with(metadata(choice, chunk_size, codecs));
  };
  const std::string bytes = R"({"name": "bytes", "configuration": {"endian": "little"}})";
  ASSERT_EQ(with(plain), "");
  EXPECT_THAT(with("{"), HasSubstr("it is no JSON object"));
  EXPECT_THAT(with("{}"), HasSubstr("its metadata is damaged"));
  EXPECT_THAT(changed(R"("zarr_format": 3)", R"("zarr_format": 4)"), HasSubstr("it is of version 4"));
  EXPECT_THAT(changed("uint16", "complex64"), HasSubstr("elements of type complex64 are no scalars"));
  EXPECT_THAT(changed("regular", "rectangular"), HasSubstr("a grid of kind 'rectangular'"));
  EXPECT_THAT(changed(R"("default")", R"("fanout")"), HasSubstr("named in the way 'fanout'"));
  EXPECT_THAT(changed("[4, 8, 16]", "[4, 8]"), HasSubstr("it has 3 axes and chunks of 2"));
  EXPECT_THAT(changed("little", "middle"), HasSubstr(R"(its byte order is "middle")"));
  EXPECT_THAT(changed(R"("endian": "little")", ""), HasSubstr("its byte order is null"));
  EXPECT_THAT(changed("[11, 21, 37]", "[11, 21, 37.5]"), HasSubstr("a length in it is 37.5"));
  for (const char* const fill : {"70000", "-1", "0.5e9", "0.5", "\"NaN\"", "\"0x00\""})
    EXPECT_THAT(changed(R"("fill_value": 0)", fmt::format(R"("fill_value": {})", fill)),
                HasSubstr(fmt::format("its fill value {} is none of type u16",
                                      std::string_view(fill) == "0.5e9" ? "500000000.0" : fill)));
  EXPECT_THAT(changed(R"("codecs")", R"("extra": {"name": "extra"}, "codecs")"), HasSubstr("it says 'extra'"));
  EXPECT_EQ(changed(R"("codecs")", R"("extra": {"must_understand": false}, "codecs")"), "");
  EXPECT_THAT(changed(R"("codecs")", R"("storage_transformers": [{"name": "a"}], "codecs")"),
              HasSubstr("it has storage transformers"));
  EXPECT_THAT(with_codecs(bytes + R"(, {"name": "bz2"})"), HasSubstr("compressed by 'bz2' are not read"));
  EXPECT_THAT(with_codecs(bytes + R"(, "zstd", "gzip")"), HasSubstr("compresses what is compressed already"));
  EXPECT_THAT(with_codecs(bytes + R"(, "crc32c", "gzip")"), HasSubstr("comes behind a checksum"));
  EXPECT_THAT(with_codecs(R"("zstd", )" + bytes), HasSubstr("its codec 'zstd' is not read before"));
  EXPECT_THAT(with_codecs(bytes + ", " + bytes), HasSubstr("comes behind one that made bytes"));
  EXPECT_THAT(with_codecs(""), HasSubstr("no codec makes bytes of its elements"));
  EXPECT_THAT(with_codecs(R"({"name": "transpose", "configuration": {"order": [0, 0, 1]}}, )" + bytes),
              HasSubstr("is no permutation"));
  EXPECT_THAT(with_codecs(sharding(choice, "end", "[4, 8, 15]")),
              HasSubstr("are no multiple of 15 of a chunk"));
  EXPECT_THAT(with_codecs(sharding(choice, "end", "[4, 8]")), HasSubstr("are no multiple of 0 of a chunk"));
  EXPECT_THAT(with_codecs(sharding(choice, "middle", "[4, 8, 16]")), HasSubstr("neither start nor end"));
  EXPECT_THAT(with_codecs(sharding(choice, "end", "[4, 8, 16]") + R"(, "zstd")"), HasSubstr("is not alone"));
  EXPECT_THAT(with(metadata(choice, {1 << 20, 1 << 20, 4}, sharding(choice, "end", "[4, 8, 16]"))),
              HasSubstr("its shards have more than"));
  write_text(folder.file("b/zarr.json"), R"({"zarr_format": 3, "node_type": "group"})");
  EXPECT_THAT(trouble_with(folder.file("b")), HasSubstr("it is a group without an image"));
}

/// 2 x 3 x 4 scalars in one chunk whose axes are transposed.
std::string small_array(const std::string& codecs) {
  return fmt::format(
      R"({{"zarr_format": 3, "node_type": "array", "shape": [2, 3, 4], "data_type": "uint8", "chunk_grid": )"
      R"({{"name": "regular", "configuration": {{"chunk_shape": [2, 3, 4]}}}}, )"
      R"("chunk_key_encoding": {{"name": "default"}}, "fill_value": 9, "codecs": [{}]}})",
      codecs);
}

TEST(ZarrVersion3, TranspositionsThatAreNotTheirOwnInverse) {
  const TemporaryFolder folder;
  Bytes scalars(24), turned, turned_twice;
  for (int i = 0; i < 24; ++i) scalars[std::size_t(i)] = std::byte(i);
  const auto at = [&](int z, int y, int x) { return scalars[std::size_t(z * 3 + y) * 4 + std::size_t(x)]; };
  // [1, 2, 0]: y, x, z, slowest first; then [0, 2, 1]: y, z, x.
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      for (int z = 0; z < 2; ++z) turned.push_back(at(z, y, x));
  for (int y = 0; y < 3; ++y)
    for (int z = 0; z < 2; ++z)
      for (int x = 0; x < 4; ++x) turned_twice.push_back(at(z, y, x));
  const std::string once = R"({"name": "transpose", "configuration": {"order": [1, 2, 0]}}, )",
                    again = R"({"name": "transpose", "configuration": {"order": [0, 2, 1]}}, )";
  write_text(folder.file("a/zarr.json"), small_array(once + R"("bytes")"));
  write_bytes(folder.file("a/c/0/0/0"), turned);
  write_text(folder.file("b/zarr.json"), small_array(once + again + R"("bytes")"));
  write_bytes(folder.file("b/c/0/0/0"), turned_twice);
  for (const char* const name : {"a", "b"}) {
    const auto file = open_volume(folder.file(name));
    EXPECT_EQ(read_box(*file, whole(*file)), scalars);
  }
}

TEST(ZarrVersion3, AnIndexMayBeBigEndianAndWithoutAChecksum) {
  const TemporaryFolder folder;
  write_text(
      folder.file("a/zarr.json"),
      small_array(
          R"({"name": "sharding_indexed", "configuration": {"chunk_shape": [2, 3, 2], "codecs": ["bytes"], )"
          R"("index_codecs": [{"name": "bytes", "configuration": {"endian": "big"}}]}})"));
  Bytes shard(12, std::byte{5});
  for (const std::uint64_t number : {~std::uint64_t{}, ~std::uint64_t{}, std::uint64_t{0}, std::uint64_t{12}})
    for (int i = 7; i >= 0; --i) shard.push_back(std::byte(number >> (8 * i)));
  write_bytes(folder.file("a/c/0/0/0"), shard);
  Bytes expected;
  for (int i = 0; i < 24; ++i) expected.push_back(i % 4 < 2 ? std::byte{9} : std::byte{5});
  const auto file = open_volume(folder.file("a"));
  EXPECT_EQ(read_box(*file, whole(*file)), expected);
}

TEST(ZarrVersion3, MetadataThatNestsDeeplyIsRefused) {
  const TemporaryFolder folder;
  const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');
  for (const char* const name : {"attributes", "fill_value", "codecs", "dimension_names"}) {
    write_text(folder.file("a/zarr.json"),
               fmt::format(R"({{"zarr_format": 3, "node_type": "array", "{}": {}}})", name, deep));
    EXPECT_THAT(trouble_with(folder.file("a")), HasSubstr("its JSON is more than 64 levels deep"));
  }
}

TEST(ZarrVersion3, ArraysThatTakeMoreWorkThanTheyHaveScalarsAreRefused) {
  const TemporaryFolder folder;
  const Version3 choice{{.type = ScalarType::u8}};
  const auto trouble = [&](const std::array<int, 3>& chunk, const std::array<int, 3>& shard,
                           const std::string& shape) {
    std::string text = metadata(choice, shard, sharding(choice, "end", numbers(chunk)));
    const std::string own = numbers(array_size);
    write_text(folder.file("a/zarr.json"), text.replace(text.find(own), own.size(), shape));
    return trouble_with(folder.file("a"));
  };
  EXPECT_THAT(trouble({1, 1, 1}, {1, 4096, 256}, "[256, 4096, 4096]"), HasSubstr("chunks of 1 scalars"));
  EXPECT_THAT(trouble({512, 1, 1}, {512, 1, 1 << 20}, "[1, 4096, 16384]"),
              HasSubstr("MiB of chunks and indices"));
  EXPECT_EQ(trouble({32, 32, 32}, {1024, 1024, 1024}, "[3, 5, 7]"), "");
}

TEST(ZarrVersion3, DamagedChunksAndIndicesAreErrors) {
  const TemporaryFolder folder;
  const Version3 choice{{.codec = ChunkCodec::zstd, .separator = '/'}, true};
  const Bytes scalars = random_scalars(array_size, choice.chunk.type, 2);
  write_array(folder.file("chunks"), scalars, choice);
  Bytes chunk = folder.read("chunks/c/0/1/1");
  chunk[20] ^= std::byte{1};
  folder.write("chunks/c/0/1/1", chunk);
  EXPECT_THAT(trouble_with(folder.file("chunks")),
              HasSubstr("c/0/1/1: Zarr: its checksum is that of other bytes"));
  write_shards(folder.file("shards"), scalars, choice, false);
  Bytes shard = folder.read("shards/c/1/0/0");
  shard[shard.size() - 9] ^= std::byte{1};
  folder.write("shards/c/1/0/0", shard);
  EXPECT_THAT(trouble_with(folder.file("shards")),
              HasSubstr("c/1/0/0: Zarr: the index of its chunks is damaged"));
  shard.resize(50);
  folder.write("shards/c/1/0/0", shard);
  EXPECT_THAT(trouble_with(folder.file("shards")), HasSubstr("it is too short for the index"));
  Bytes index;
  for (int i = 0; i < 6; ++i) {
    append_number(index, std::uint64_t(1) << 63);
    append_number(index, 16);
  }
  folder.write("shards/c/1/0/0", with_checksum(index));
  EXPECT_THAT(trouble_with(folder.file("shards")), HasSubstr("leads beyond its end"));
}

TEST(ZarrVersion3, ChangedBytesNeverDoMoreHarmThanAnError) {
  std::mt19937 random(20775);
  Survival survival;
  const TemporaryFolder folder;
  const Version3 choice{{.separator = '/'}};
  write_shards(folder.file("a"),
               Bytes(std::size_t(array_size[0] * array_size[1] * array_size[2]) * 2, std::byte{3}), choice,
               true);
  for (const char* const name : {"a/zarr.json", "a/c/1/0/0"})
    read_with_damage(folder, name, "a", 400, random, survival);
  std::printf("%d were read, %d refused\n", survival.read, survival.refused);
  EXPECT_GT(survival.refused, 100);
  EXPECT_GT(survival.read, 50);
}

}  // namespace
}  // namespace understudy::volume::testing
