// SPDX-License-Identifier: Apache-2.0
// Zarr arrays (version 2) and OME-Zarr images: every codec, order and type, levels, channels and time steps.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>

#include "tests/volume/file/volume_files.h"
#include "tests/volume/file/zarr_files.h"
#include "volume/file/chunks/chunk_codec.h"
#include "volume/file/chunks/element_type.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume::testing {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string dtype_of(const ZarrChoice& choice) {
  using enum ScalarType;
  const char kind = choice.type == f32 || choice.type == f64                                              ? 'f'
                    : choice.type == i8 || choice.type == i16 || choice.type == i32 || choice.type == i64 ? 'i'
                                                                                                          : 'u';
  return fmt::format("{}{}{}", choice.big_endian ? '>' : '<', kind, bytes_per_scalar(choice.type));
}

std::string compressor_of(ChunkCodec codec) {
  switch (codec) {
    case ChunkCodec::none:
      return "null";
    case ChunkCodec::blosc:
      return R"({"id": "blosc", "cname": "lz4", "clevel": 5, "shuffle": 1})";
    case ChunkCodec::zlib:
      return R"({"id": "gzip", "level": 5})";
    case ChunkCodec::zstd:
      return R"({"id": "zstd", "level": 3})";
    case ChunkCodec::lz4:
      return R"({"id": "lz4", "acceleration": 1})";
  }
  return "";
}

/// `before`: the chunk's indices along axes before z, each followed by the separator.
void write_chunks(const std::filesystem::path& folder, const Bytes& scalars, const ZarrChoice& choice,
                  const std::string& before = "") {
  for (int z = 0; z * chunk_size[2] < array_size[2]; ++z)
    for (int y = 0; y * chunk_size[1] < array_size[1]; ++y)
      for (int x = 0; x * chunk_size[0] < array_size[0]; ++x)
        write_bytes(folder / fmt::format("{}{}{}{}{}{}", before, z, choice.separator, y, choice.separator, x),
                    packed(chunk_of(scalars, {x * chunk_size[0], y * chunk_size[1], z * chunk_size[2]}, choice),
                           choice.codec, bytes_per_scalar(choice.type)));
}

std::string metadata(const ZarrChoice& choice, const std::string& shape_before = "",
                     const std::string& chunks_before = "", const std::string& fill = "0") {
  return fmt::format(
      R"({{"zarr_format": 2, "shape": [{}{}, {}, {}], "chunks": [{}{}, {}, {}], "dtype": "{}", "order": "{}", )"
      R"("fill_value": {}, "filters": null, "compressor": {}, "dimension_separator": "{}"}})",
      shape_before, array_size[2], array_size[1], array_size[0], chunks_before, chunk_size[2], chunk_size[1],
      chunk_size[0], dtype_of(choice), choice.first_axis_fastest ? "F" : "C", fill, compressor_of(choice.codec),
      choice.separator);
}

TEST(ZarrArray, EveryTypeOrderAndCodec) {
  using enum ScalarType;
  for (const ScalarType type : {u8, i8, u16, i16, u32, i32, u64, i64, f32, f64})
    for (const ChunkCodec codec :
         {ChunkCodec::none, ChunkCodec::blosc, ChunkCodec::zlib, ChunkCodec::zstd, ChunkCodec::lz4})
      for (const bool other_way : {false, true}) {
        SCOPED_TRACE(fmt::format("{} {} {}", name_of(type), int(codec), other_way));
        const TemporaryFolder folder;
        const ZarrChoice choice{type, codec, other_way, other_way, other_way ? '/' : '.'};
        const Bytes scalars = random_scalars(array_size, type, 1 + unsigned(type));
        write_text(folder.file("a.zarr/.zarray"), metadata(choice));
        write_chunks(folder.file("a.zarr"), scalars, choice);
        const auto file = open_volume(folder.file("a.zarr"));
        ASSERT_EQ(file->description().size, array_size);
        ASSERT_EQ(file->description().type, type);
        ASSERT_EQ(read_box(*file, whole(*file)), scalars);
        std::mt19937 random(3);
        for (int i = 0; i < 10; ++i) {
          const TexelBox box = random_box(array_size, random);
          Bytes expected(texels_in(box) * bytes_per_scalar(type));
          copy_texels(box, bytes_per_scalar(type), whole(*file), scalars, box, expected);
          ASSERT_EQ(read_box(*file, box), expected);
        }
      }
}

TEST(HalfPrecision, EveryBitPatternIsTheFloatOfItsValue) {
  for (std::uint32_t bits = 0; bits < 65536; ++bits)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(float_of_half(std::uint16_t(bits))),
              std::bit_cast<std::uint32_t>(half_by_definition(std::uint16_t(bits))))
        << bits;
}

TEST(ZarrArray, BooleansAreReadAsBytesAndHalvesAsFloats) {
  for (const ChunkCodec codec : {ChunkCodec::none, ChunkCodec::blosc, ChunkCodec::zstd})
    for (const bool other_way : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", int(codec), other_way));
      const TemporaryFolder folder;
      const ZarrChoice halves{ScalarType::u16, codec, other_way, other_way, '.'};
      const Bytes elements = random_scalars(array_size, halves.type, 5);
      write_text(folder.file("a.zarr/.zarray"), replaced(metadata(halves), "u2", "f2"));
      write_chunks(folder.file("a.zarr"), elements, halves);
      const auto file = open_volume(folder.file("a.zarr"));
      ASSERT_EQ(file->description().type, ScalarType::f32);
      EXPECT_EQ(read_box(*file, whole(*file)), read_as_halves(elements));
      const TexelBox corner{{20, 3, 5}, {37, 9, 11}};
      Bytes expected(texels_in(corner) * sizeof(float));
      copy_texels(corner, sizeof(float), whole(*file), read_as_halves(elements), corner, expected);
      EXPECT_EQ(read_box(*file, corner), expected);

      const ZarrChoice booleans{ScalarType::u8, codec, false, other_way, '.'};
      Bytes truths = random_scalars(array_size, booleans.type, 6);
      for (std::size_t i = 0; i < truths.size(); i += 3) truths[i] = std::byte{0};
      write_text(folder.file("b.zarr/.zarray"), replaced(metadata(booleans, "", "", "true"), "<u1", "|b1"));
      write_chunks(folder.file("b.zarr"), truths, booleans);
      std::filesystem::remove(folder.file("b.zarr/0.0.0"));
      const auto mask = open_volume(folder.file("b.zarr"));
      ASSERT_EQ(mask->description().type, ScalarType::u8);
      Bytes filled = read_as_booleans(truths);
      for (int z = 0; z < chunk_size[2]; ++z)
        for (int y = 0; y < chunk_size[1]; ++y)
          for (int x = 0; x < chunk_size[0]; ++x)
            filled[std::size_t(z * array_size[1] + y) * std::size_t(array_size[0]) + std::size_t(x)] =
                std::byte{1};
      EXPECT_EQ(read_box(*mask, whole(*mask)), filled);
    }
}

TEST(ZarrArray, ChunksThatAreNotThereHaveOneValue) {
  const TemporaryFolder folder;
  const ZarrChoice choice{.type = ScalarType::i16};
  write_text(folder.file("a.zarr/.zarray"), metadata(choice, "", "", "-1000"));
  const auto file = open_volume(folder.file("a.zarr"));
  EXPECT_EQ(read_box(*file, whole(*file)),
            bytes_of(std::vector<std::int16_t>(texels_in(whole(*file)), std::int16_t(-1000))));
  EXPECT_EQ(file->bytes_read(), 0);
}

TEST(ZarrArray, SlicesInOrderReadEachChunkOnce) {
  const TemporaryFolder folder;
  const ZarrChoice choice{.codec = ChunkCodec::blosc};
  const Bytes scalars = random_scalars(array_size, choice.type, 2);
  write_text(folder.file("a.zarr/.zarray"), metadata(choice));
  write_chunks(folder.file("a.zarr"), scalars, choice);
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("a.zarr")))
    if (entry.path().filename() != ".zarray") bytes += entry.file_size();
  const auto file = open_volume(folder.file("a.zarr"));
  for (int z = 0; z < array_size[2]; ++z) read_box(*file, {{0, 0, z}, {array_size[0], array_size[1], z + 1}});
  EXPECT_EQ(file->bytes_read(), bytes);
}

TEST(ZarrArray, FoldersThatNobodyTellsOfAreFound) {
  const TemporaryFolder folder;
  const ZarrChoice choice{.separator = '/'};
  const Bytes scalars = random_scalars(array_size, choice.type, 2);
  std::string text = metadata(choice);
  const std::string told = R"(, "dimension_separator": "/")";
  write_text(folder.file("a.zarr/.zarray"), text.erase(text.find(told), told.size()));
  write_chunks(folder.file("a.zarr"), scalars, choice);
  const auto file = open_volume(folder.file("a.zarr"));
  EXPECT_EQ(read_box(*file, whole(*file)), scalars);
}

TEST(ZarrArray, FoldersAreFoundWhereTheFirstChunksAreEmpty) {
  const TemporaryFolder folder;
  const ZarrChoice choice{.separator = '/'};
  Bytes scalars = random_scalars(array_size, choice.type, 2);
  std::fill_n(scalars.begin(), array_size[0] * array_size[1] * chunk_size[2] * 2, std::byte{});
  std::string text = metadata(choice);
  const std::string told = R"(, "dimension_separator": "/")";
  write_text(folder.file("a.zarr/.zarray"), text.erase(text.find(told), told.size()));
  write_chunks(folder.file("a.zarr"), scalars, choice);
  std::filesystem::remove_all(folder.file("a.zarr/0"));
  const auto file = open_volume(folder.file("a.zarr"));
  EXPECT_EQ(read_box(*file, whole(*file)), scalars);
}

TEST(ZarrArray, PackedValuesMeanWhatAttributesSay) {
  const TemporaryFolder folder;
  write_text(folder.file("a.zarr/.zarray"), metadata({}));
  write_text(folder.file("a.zarr/.zattrs"), R"({"scale_factor": 0.5, "add_offset": -20})");
  const auto file = open_volume(folder.file("a.zarr"));
  EXPECT_EQ(file->description().scale, 0.5);
  EXPECT_EQ(file->description().offset, -20);
  // Python writes NaN and infinities, which JSON does not have.
  write_text(folder.file("a.zarr/.zattrs"), R"({"scale_factor": NaN})");
  EXPECT_EQ(trouble_with(folder.file("a.zarr")), "");
}

TEST(ZarrArray, MemoryIsThatOfALayerOfChunks) {
  const TemporaryFolder folder;
  const ZarrChoice choice{};
  write_text(folder.file("a.zarr/.zarray"), metadata(choice));
  write_chunks(folder.file("a.zarr"), random_scalars(array_size, choice.type, 2), choice);
  const auto file = open_volume(folder.file("a.zarr"));
  const std::size_t chunk = std::size_t(chunk_size[0] * chunk_size[1] * chunk_size[2]) * 2;
  EXPECT_GE(file->memory_to_read(whole(*file)), 10 * chunk);  // 3 x 3 chunks, and a compressed one
  EXPECT_LE(file->memory_to_read(whole(*file)), 12 * chunk + 65536);
}

TEST(ZarrArray, DimensionsHaveTheNamesThatTheyAreGiven) {
  const TemporaryFolder folder;
  const ZarrChoice choice{};
  const Bytes scalars = random_scalars(array_size, choice.type, 2);
  write_text(folder.file("a.zarr/.zarray"), metadata(choice));
  write_text(folder.file("a.zarr/.zattrs"), R"({"_ARRAY_DIMENSIONS": ["time", "y", "x"]})");
  write_chunks(folder.file("a.zarr"), scalars, choice);
  const auto file = open_volume(folder.file("a.zarr"), at_step(4));
  EXPECT_EQ(file->description().time_steps, array_size[2]);
  Bytes expected(std::size_t(array_size[0] * array_size[1]) * 2);
  std::copy_n(scalars.begin() + 4 * std::ptrdiff_t(expected.size()), expected.size(), expected.begin());
  EXPECT_EQ(read_box(*file, whole(*file)), expected);
}

TEST(ZarrArray, ChunksThatWereNotFetchedAreAnError) {
  const TemporaryFolder folder;
  write_text(folder.file("a.zarr/.zarray"), metadata({}));
  std::filesystem::create_symlink("../annex/key", folder.file("a.zarr/0.0.0"));
  EXPECT_THAT(trouble_with(folder.file("a.zarr")), HasSubstr("is a link to a file that is not there"));
}

TEST(ZarrArray, FoldersAreReadOnlyWhereClientsMay) {
  const TemporaryFolder allowed, other;
  const ZarrChoice choice{.separator = '/'};
  const Bytes scalars = random_scalars(array_size, choice.type, 2);
  for (const TemporaryFolder* folder : {&allowed, &other}) {
    write_text(folder->file("a.zarr/.zarray"), metadata(choice));
    write_chunks(folder->file("a.zarr"), scalars, choice);
  }
  const std::string parent = std::filesystem::path(allowed.file("")).parent_path();
  const ReadableFiles files(std::span(&parent, 1));
  EXPECT_EQ(read_box(*open_volume(parent + "/a.zarr", {}, files), {{0, 0, 0}, array_size}), scalars);
  EXPECT_THAT(trouble_with(other.file("a.zarr"), {}, files), HasSubstr("lies in none of the folders"));
  // A link that leads out of the folder is not followed either.
  std::filesystem::remove_all(allowed.file("a.zarr/0"));
  std::filesystem::create_directory_symlink(other.file("a.zarr/0"), allowed.file("a.zarr/0"));
  EXPECT_THAT(trouble_with(parent + "/a.zarr", {}, files), HasSubstr("lies in none of the folders"));
}

TEST(OmeZarr, LevelsChannelsTimeStepsAndSpacing) {
  const TemporaryFolder folder;
  const ZarrChoice choice{.codec = ChunkCodec::blosc, .separator = '/'};
  write_text(folder.file("a.zarr/.zgroup"), R"({"zarr_format": 2})");
  write_text(folder.file("a.zarr/.zattrs"), R"({"multiscales": [{"version": "0.4", "axes": [
      {"name": "t", "type": "time"}, {"name": "c", "type": "channel"},
      {"name": "z", "type": "space", "unit": "micrometer"}, {"name": "y", "type": "space", "unit": "nanometer"},
      {"name": "x", "type": "space", "unit": "nanometer"}],
    "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 2, 1, 1]}], "datasets": [
      {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 0.5, 250, 200]}]},
      {"path": "1", "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 0.5, 500, 400]}]}]}]})");
  for (const char* const level : {"0", "1"})
    write_text(folder.file("a.zarr/") + level + "/.zarray", metadata(choice, "2, 3, ", "1, 2, "));
  // Two channels share a chunk.
  const auto scalars_of = [&](int level, int step, int channel) {
    return random_scalars(array_size, choice.type, unsigned(100 * level + 10 * step + channel + 1));
  };
  for (int level = 0; level < 2; ++level)
    for (int step = 0; step < 2; ++step)
      for (int pair = 0; pair < 2; ++pair)
        for (int z = 0; z * chunk_size[2] < array_size[2]; ++z)
          for (int y = 0; y * chunk_size[1] < array_size[1]; ++y)
            for (int x = 0; x * chunk_size[0] < array_size[0]; ++x) {
              const std::array<int, 3> low{x * chunk_size[0], y * chunk_size[1], z * chunk_size[2]};
              const Bytes chunk = joined(chunk_of(scalars_of(level, step, 2 * pair), low, choice),
                                         chunk_of(scalars_of(level, step, 2 * pair + 1), low, choice));
              write_bytes(folder.file(fmt::format("a.zarr/{}/{}/{}/{}/{}/{}", level, step, pair, z, y, x)),
                          packed(chunk, choice.codec, 2));
            }
  for (int level = 0; level < 2; ++level)
    for (int step = 0; step < 2; ++step)
      for (int channel = 0; channel < 3; ++channel) {
        FileHints hints = at_step(step);
        hints.level = level;
        hints.channel = channel;
        const auto file = open_volume(folder.file("a.zarr"), hints);
        EXPECT_EQ(file->description().time_steps, 2);
        EXPECT_THAT(file->description().spacing,
                    ElementsAre(DoubleNear(200 << level, 1e-9), DoubleNear(250 << level, 1e-9),
                                DoubleNear(1000, 1e-9)));
        EXPECT_EQ(read_box(*file, whole(*file)), scalars_of(level, step, channel));
      }
  EXPECT_THAT(trouble_with(folder.file("a.zarr")),
              HasSubstr("it has 3 channels; choose one: --channel 0 to 2"));
  FileHints beyond;
  beyond.channel = 3;
  EXPECT_THAT(trouble_with(folder.file("a.zarr"), beyond), HasSubstr("there is no channel 3 in it; it has 3"));
  beyond.level = 2;
  EXPECT_THAT(trouble_with(folder.file("a.zarr"), beyond), HasSubstr("it has no level 2; it has 2"));
}

/// `axes`: followed by a comma, or empty.
std::string image_text(const std::string& version, const std::string& axes) {
  return fmt::format(R"({{"multiscales": [{{"version": "{}", {} "datasets": [{{"path": "scale0/image"}}]}}]}})",
                     version, axes);
}

TEST(OmeZarr, AxesUnitsAndVersions) {
  const TemporaryFolder folder;
  const ZarrChoice choice{};
  write_text(folder.file("a.zarr/.zgroup"), "{}");
  write_text(folder.file("a.zarr/scale0/.zgroup"), "{}");
  write_text(folder.file("a.zarr/scale0/image/.zarray"), metadata(choice));
  const auto with = [&](const std::string& version, const std::string& axes) {
    write_text(folder.file("a.zarr/.zattrs"), image_text(version, axes));
    return trouble_with(folder.file("a.zarr"));
  };
  const auto axes_in = [](const std::string& z, const std::string& yx) {
    return fmt::format(R"("axes": [{{"name": "Z", "type": "space"{}}}, {{"name": "Y", "type": "space"{}}},
                                   {{"name": "X", "type": "space"{}}}],)",
                       z, yx, yx);
  };
  const std::string furlong = R"(, "unit": "furlong")", micrometer = R"(, "unit": "micrometer")";
  EXPECT_EQ(with("0.4", axes_in("", "")), "");
  EXPECT_EQ(with("0.4", axes_in(furlong, furlong)), "");
  EXPECT_EQ(with("0.2", ""), "");
  EXPECT_THAT(with("0.4", axes_in(furlong, micrometer)), HasSubstr("one of its axes is in 'furlong'"));
  EXPECT_THAT(with("0.4", ""), HasSubstr("it tells no axes, as OME-Zarr 0.4 has to"));
  EXPECT_THAT(with("0.6", axes_in("", "")), HasSubstr("it is of OME-Zarr 0.6, of which 0.1 to 0.5 are read"));
  EXPECT_THAT(with("0.4", R"("axes": ["z", "q", "x"],)"), HasSubstr("it has an axis 'q'"));
  EXPECT_THAT(with("0.4", R"("axes": ["z", "y"],)"), HasSubstr("its array has 3 axes, and 2 are told"));
  EXPECT_THAT(with("0.4", R"("axes": ["z", "y", "y"],)"), HasSubstr("one of its axes is told twice"));
  EXPECT_THAT(with("0.4", R"("axes": ["t", "z", "y"],)"), HasSubstr("it has no axis x"));
  // Axes are not described at a single level, whatever the working directory is.
  EXPECT_THAT(trouble_with(folder.file("a.zarr/scale0/image")), HasSubstr("it is a level of the image"));
}

TEST(ZarrArray, WhatIsNoVolumeSaysWhy) {
  const TemporaryFolder folder;
  const std::string name = folder.file("a.zarr");
  const auto with = [&](const std::string& text) {
    write_text(name + "/.zarray", text);
    return trouble_with(name);
  };
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = metadata({});
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(with("{"), HasSubstr("it is no JSON object"));
  EXPECT_THAT(with("{}"), HasSubstr("its metadata is damaged"));
  EXPECT_THAT(with(changed("<u2", "<c8")), HasSubstr("elements of type <c8 are no scalars"));
  EXPECT_THAT(with(changed("\"filters\": null", R"("filters": [{"id": "delta"}])")),
              HasSubstr("went through filters"));
  EXPECT_THAT(with(changed("\"compressor\": null", R"("compressor": {"id": "bz2"})")),
              HasSubstr("compressed by 'bz2' are not read"));
  std::string deep(100'000, '[');
  EXPECT_NE(with(changed("\"<u2\"", deep + std::string(100'000, ']'))), "");
  EXPECT_THAT(with(changed("[4, 8, 16]", "[4, 8]")), HasSubstr("it has 3 axes and chunks of 2"));
  EXPECT_THAT(with(changed("[4, 8, 16]", "[4, 0, 16]")), HasSubstr("in chunks of 0"));
  EXPECT_THAT(with(changed("[4, 8, 16]", "[65536, 65536, 16]")), HasSubstr("its chunks have 2 GiB or more"));
  EXPECT_THAT(with(changed("[11, 21, 37]", "[11, 21, 37000000]")), HasSubstr("check its metadata"));
  write_text(name + "/0.0.0", "short");
  EXPECT_THAT(with(metadata({})),
              HasSubstr("0.0.0: Zarr: its compressed bytes are damaged, or of another size"));
  write_text(folder.file("c.zarr/.zgroup"), "{}");
  EXPECT_THAT(trouble_with(folder.file("c.zarr")), HasSubstr("it is a group without an image"));
  write_text(folder.file("c.zarr/.zattrs"), R"({"multiscales": [{"datasets": [{"path": "../a.zarr"}]}]})");
  EXPECT_THAT(trouble_with(folder.file("c.zarr")), HasSubstr("one of its levels lies elsewhere"));
}

TEST(ZarrArray, ChangedBytesNeverDoMoreHarmThanAnError) {
  std::mt19937 random(20774);
  Survival survival;
  for (const ChunkCodec codec : {ChunkCodec::blosc, ChunkCodec::zlib, ChunkCodec::zstd, ChunkCodec::lz4}) {
    const TemporaryFolder folder;
    const ZarrChoice choice{.codec = codec};
    const Bytes scalars(std::size_t(array_size[0] * array_size[1] * array_size[2]) * 2, std::byte{3});
    write_text(folder.file("a.zarr/.zarray"), metadata(choice));
    write_chunks(folder.file("a.zarr"), scalars, choice);
    for (const char* const name : {"a.zarr/.zarray", "a.zarr/0.1.1"})
      read_with_damage(folder, name, "a.zarr", 150, random, survival);
  }
  std::printf("%d were read, %d refused\n", survival.read, survival.refused);
  EXPECT_GT(survival.refused, 100);
  EXPECT_GT(survival.read, 50);
}

}  // namespace
}  // namespace understudy::volume::testing
