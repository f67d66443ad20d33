// SPDX-License-Identifier: Apache-2.0
// TIFF stacks: pages of a file, as ImageJ and OME describe them, and folders of files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <filesystem>

#include "tests/volume/file/volume_files.h"
#include "volume/file/file_error.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::array<int, 3> stack_size{37, 21, 5};

struct TiffChoice {
  const char* mode = "w";  ///< l, b: byte order; 8: BigTIFF
  ScalarType type = ScalarType::u16;
  int compression = COMPRESSION_NONE;
  bool tiled = false;
  std::string description = {};
  int meaning = PHOTOMETRIC_MINISBLACK;
  float resolution = 0;
};

int format_of(ScalarType type) {
  using enum ScalarType;
  return type == f32 || type == f64                                ? SAMPLEFORMAT_IEEEFP
         : type == i8 || type == i16 || type == i32 || type == i64 ? SAMPLEFORMAT_INT
                                                                   : SAMPLEFORMAT_UINT;
}

void write_page(TIFF* tiff, const TiffChoice& choice, const std::array<int, 2>& pixels, Bytes scalars) {
  const std::size_t scalar = bytes_per_scalar(choice.type);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, std::uint32_t(pixels[0]));
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, std::uint32_t(pixels[1]));
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, int(8 * scalar));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format_of(choice.type));
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, choice.meaning);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, choice.compression);
  if (!choice.description.empty()) TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, choice.description.c_str());
  if (choice.resolution > 0) {
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, double(choice.resolution));
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, double(choice.resolution));
  }
  constexpr int rows_of_strip = 4, side = 16;
  if (!choice.tiled) {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, rows_of_strip);
    const std::size_t row = std::size_t(pixels[0]) * scalar;
    for (int y = 0; y < pixels[1]; y += rows_of_strip)
      TIFFWriteEncodedStrip(tiff, std::uint32_t(y / rows_of_strip), scalars.data() + std::size_t(y) * row,
                            tmsize_t(row * std::size_t(std::min(rows_of_strip, pixels[1] - y))));
  } else {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, side);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, side);
    for (int y = 0; y < pixels[1]; y += side)
      for (int x = 0; x < pixels[0]; x += side) {
        Bytes tile(side * side * scalar);
        const TexelBox whole_page{{0, 0, 0}, {pixels[0], pixels[1], 1}},
            part{{x, y, 0}, {std::min(x + side, pixels[0]), std::min(y + side, pixels[1]), 1}};
        copy_texels(part, scalar, whole_page, scalars, {{x, y, 0}, {x + side, y + side, 1}}, tile);
        TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, std::uint32_t(x), std::uint32_t(y), 0, 0), tile.data(),
                             tmsize_t(tile.size()));
      }
  }
  TIFFWriteDirectory(tiff);
}

Bytes page_of(const Bytes& scalars, int page, int pages) {
  const std::size_t bytes = scalars.size() / std::size_t(pages);
  const auto first = scalars.begin() + std::ptrdiff_t(bytes) * page;
  return {first, first + std::ptrdiff_t(bytes)};
}

std::string write_pages(const std::string& path, const TiffChoice& choice, const Bytes& scalars,
                        int pages = stack_size[2]) {
  TIFF* const tiff = TIFFOpen(path.c_str(), choice.mode);
  for (int page = 0; page < pages; ++page)
    write_page(tiff, choice, {stack_size[0], stack_size[1]}, page_of(scalars, page, pages));
  TIFFClose(tiff);
  return path;
}

TEST(TiffFile, EveryTypeByteOrderAndCompressionInStripsAndTiles) {
  const TemporaryFolder folder;
  using enum ScalarType;
  for (const ScalarType type : {u8, i8, u16, i16, u32, i32, u64, i64, f32, f64}) {
    const Bytes scalars = random_scalars(stack_size, type, 1 + unsigned(type));
    for (const char* mode : {"wl", "wb", "wl8", "wb8"})
      for (const int compression :
           {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS})
        for (const bool tiled : {false, true}) {
          SCOPED_TRACE(fmt::format("{} {} {} {}", name_of(type), mode, compression, tiled));
          const std::string path =
              write_pages(folder.file("a.tif"),
                          {.mode = mode, .type = type, .compression = compression, .tiled = tiled}, scalars);
          const auto file = open_volume(path);
          ASSERT_EQ(file->description().size, stack_size);
          ASSERT_EQ(file->description().type, type);
          ASSERT_EQ(read_box(*file, whole(*file)), scalars);
          const TexelBox box{{5, 2, 1}, {30, 20, 4}};
          Bytes expected(texels_in(box) * bytes_per_scalar(type));
          copy_texels(box, bytes_per_scalar(type), whole(*file), scalars, box, expected);
          ASSERT_EQ(read_box(*file, box), expected);
        }
  }
}

TEST(TiffFile, StacksOfImageJHaveTimeStepsAndSpacing) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars({stack_size[0], stack_size[1], 6}, ScalarType::u16, 1);
  const std::string path =
      write_pages(folder.file("a.tif"),
                  {.description = "ImageJ=1.53t\nimages=6\nslices=3\nframes=2\nhyperstack=true\nspacing=2.5\n",
                   .resolution = 4},
                  scalars, 6);
  for (int t = 0; t < 2; ++t) {
    const auto file = open_volume(path, at_step(t));
    EXPECT_EQ(file->description().time_steps, 2);
    EXPECT_THAT(file->description().spacing, ElementsAre(0.25, 0.25, 2.5));
    EXPECT_EQ(read_box(*file, whole(*file)), page_of(scalars, t, 2));
  }
  const std::string channels = write_pages(
      folder.file("b.tif"), {.description = "ImageJ=1.53t\nimages=6\nchannels=2\nslices=3\n"}, scalars, 6);
  EXPECT_THAT(trouble_with(channels), HasSubstr("it has 2 channels; choose one: --channel 0 to 1"));
  FileHints second;
  second.channel = 1;
  Bytes expected;
  for (const int page : {1, 3, 5}) expected = joined(expected, page_of(scalars, page, 6));
  EXPECT_EQ(read_box(*open_volume(channels, second), {{0, 0, 0}, {stack_size[0], stack_size[1], 3}}), expected);
  EXPECT_THAT(trouble_with(write_pages(folder.file("c.tif"),
                                       {.description = "ImageJ=1.53t\nimages=9\nslices=9\n"}, scalars, 6)),
              HasSubstr("it speaks of 9 images, but has 6"));
}

/// Beyond 4 GB, ImageJ writes one directory followed by the pixels of all images.
TEST(TiffFile, ImagesOfImageJBehindTheOnlyPage) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(stack_size, ScalarType::u16, 2);
  for (const bool big : {false, true}) {
    const Bytes stored = big ? swapped(scalars, 2) : scalars;
    const std::string words = fmt::format("ImageJ=1.53t\nimages={}\nslices={}\n", stack_size[2], stack_size[2]);
    const auto number = [&](std::uint32_t value, std::size_t bytes) {
      Bytes text;
      for (std::size_t i = 0; i < bytes; ++i)
        text.push_back(std::byte(value >> (8 * (big ? bytes - 1 - i : i))));
      return text;
    };
    constexpr std::uint32_t entries = 10, directory = 8, behind = directory + 2 + entries * 12 + 4;
    Bytes file = joined(joined(text_bytes(big ? "MM" : "II"), number(42, 2)), number(directory, 4));
    file = joined(file, number(entries, 2));
    const auto entry = [&](std::uint32_t tag, std::uint32_t type, std::uint32_t count, std::uint32_t value) {
      file = joined(joined(joined(file, number(tag, 2)), number(type, 2)), number(count, 4));
      file = joined(file, type == 3 ? joined(number(value, 2), number(0, 2)) : number(value, 4));
    };
    const auto text_size = std::uint32_t(words.size() + 1);
    entry(TIFFTAG_IMAGEWIDTH, 4, 1, stack_size[0]);
    entry(TIFFTAG_IMAGELENGTH, 4, 1, stack_size[1]);
    entry(TIFFTAG_BITSPERSAMPLE, 3, 1, 16);
    entry(TIFFTAG_COMPRESSION, 3, 1, COMPRESSION_NONE);
    entry(TIFFTAG_PHOTOMETRIC, 3, 1, PHOTOMETRIC_MINISBLACK);
    entry(TIFFTAG_IMAGEDESCRIPTION, 2, text_size, behind);
    entry(TIFFTAG_STRIPOFFSETS, 4, 1, behind + text_size);
    entry(TIFFTAG_SAMPLESPERPIXEL, 3, 1, 1);
    entry(TIFFTAG_ROWSPERSTRIP, 3, 1, stack_size[1]);
    entry(TIFFTAG_STRIPBYTECOUNTS, 4, 1, std::uint32_t(stack_size[0] * stack_size[1] * 2));
    file = joined(joined(joined(file, number(0, 4)), text_bytes(words + '\0')), stored);
    const std::string path = folder.write("a.tif", file);
    const auto volume = open_volume(path);
    ASSERT_EQ(volume->description().size, stack_size);
    EXPECT_EQ(read_box(*volume, whole(*volume)), scalars);
    file.resize(file.size() - 1);
    EXPECT_THAT(trouble_with(folder.write("b.tif", file)), HasSubstr("truncated"));
  }
}

TEST(TiffFile, StacksOfOmeInEitherOrder) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars({stack_size[0], stack_size[1], 6}, ScalarType::u16, 3);
  const auto with = [&](const std::string& attributes) {
    return write_pages(
        folder.file("a.ome.tif"),
        {.description =
             "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\">"
             "<Image ID=\"Image:0\"><Pixels " +
             attributes + "><TiffData/></Pixels></Image></OME>"},
        scalars, 6);
  };
  const std::string sizes = "SizeX='37' SizeY='21' SizeZ='3' SizeC='1' SizeT='2' Type='uint16' ";
  const std::string first = with(sizes +
                                 "DimensionOrder='XYZCT' PhysicalSizeX='250' PhysicalSizeXUnit='nm' "
                                 "PhysicalSizeY='0.25' PhysicalSizeZ='2'");
  EXPECT_THAT(open_volume(first)->description().spacing,
              ElementsAre(::testing::DoubleNear(250, 1e-9), ::testing::DoubleNear(250, 1e-9),
                          ::testing::DoubleNear(2000, 1e-9)));
  EXPECT_EQ(read_box(*open_volume(first, at_step(1)), {{0, 0, 0}, {stack_size[0], stack_size[1], 3}}),
            page_of(scalars, 1, 2));
  const std::string second = with(sizes + "DimensionOrder='XYCTZ'");
  Bytes expected;
  for (const int page : {1, 3, 5}) expected = joined(expected, page_of(scalars, page, 6));
  EXPECT_EQ(read_box(*open_volume(second, at_step(1)), {{0, 0, 0}, {stack_size[0], stack_size[1], 3}}),
            expected);
  EXPECT_THAT(
      trouble_with(with(sizes + "DimensionOrder='XYZCT'><TiffData IFD='0' FirstZ='2'/><TiffData IFD='1'")),
      HasSubstr("its page 0 holds what should be in page 2"));
  EXPECT_THAT(trouble_with(with("SizeZ='12' SizeC='1' SizeT='2'")),
              HasSubstr("it speaks of 24 images, but has 6"));
}

TEST(TiffFolder, FilesAreSlicesInTheOrderOfTheirNumbers) {
  const TemporaryFolder folder;
  constexpr std::array<int, 3> tall{stack_size[0], stack_size[1], 12};
  const Bytes scalars = random_scalars(tall, ScalarType::u16, 4);
  for (int z = 0; z < tall[2]; ++z)
    write_pages(folder.file(fmt::format("slice_{}.tif", z)), {}, page_of(scalars, z, tall[2]), 1);
  folder.write("notes.txt", "not a slice");
  folder.write(".hidden.tif", "II*");
  const auto file = open_volume(folder.file(""));
  ASSERT_EQ(file->description().size, tall);
  EXPECT_EQ(read_box(*file, whole(*file)), scalars);
  std::filesystem::rename(folder.file("slice_7.tif"), folder.file(".kept"));
  EXPECT_THAT(trouble_with(folder.file("")), HasSubstr("slice_8.tif: does not follow slice_6.tif"));
  std::filesystem::rename(folder.file(".kept"), folder.file("slice_7.tif"));
  write_pages(folder.file("slice_mask.tif"), {}, page_of(scalars, 0, tall[2]), 1);
  EXPECT_THAT(trouble_with(folder.file("")), HasSubstr("slice_mask.tif: does not follow slice_11.tif"));
  std::filesystem::remove(folder.file("slice_mask.tif"));
  folder.write("slice_12.tif", "");
  EXPECT_THAT(trouble_with(folder.file("")), HasSubstr("slice_12.tif: is named as a TIFF file, but is none"));
  std::filesystem::remove(folder.file("slice_12.tif"));
  write_pages(folder.file("slice_5.tif"), {}, scalars, 2);
  EXPECT_THAT(trouble_with(folder.file("")), AllOf(HasSubstr("slice_5.tif"), HasSubstr("2 slices of 37 x 21")));
}

TEST(TiffFile, ChangedBytesNeverDoMoreHarmThanAnError) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(stack_size, ScalarType::u16, 6);
  const std::string words = "ImageJ=1.53t\nimages=5\nslices=5\nspacing=2\n";
  std::mt19937 random(20773);
  int survived = 0, refused = 0;
  for (const TiffChoice& choice : {TiffChoice{.compression = COMPRESSION_LZW, .description = words},
                                   TiffChoice{.compression = COMPRESSION_ADOBE_DEFLATE, .tiled = true}}) {
    write_pages(folder.file("good.tif"), choice, scalars);
    const Bytes good = folder.read("good.tif");
    for (int i = 0; i < 500; ++i) {
      const std::string path = folder.write("m.tif", damaged(good, random));
      const std::string trouble = trouble_with(path);
      ++(trouble.empty() ? survived : refused);
      if (!trouble.empty()) {
        EXPECT_THAT(trouble, HasSubstr(path + ": "));
      }
    }
  }
  std::printf("%d were read, %d refused\n", survived, refused);
  EXPECT_GT(refused, 100);
}

TEST(TiffFile, WhatIsNoVolumeSaysWhy) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(stack_size, ScalarType::u16, 5);
  EXPECT_THAT(trouble_with(write_pages(folder.file("a.tif"), {.meaning = PHOTOMETRIC_MASK}, scalars)),
              HasSubstr("its pixels are colours, not scalars"));
  const std::string whole_file = write_pages(folder.file("b.tif"), {.compression = COMPRESSION_LZW}, scalars);
  std::filesystem::resize_file(whole_file, std::filesystem::file_size(whole_file) - 100);
  EXPECT_THAT(trouble_with(whole_file), HasSubstr("get the file again"));
  EXPECT_THAT(trouble_with(folder.write("c.tif", std::string("II*\0\xff\xff\xff\0", 8))),
              HasSubstr("get the file again"));
  TIFF* const tiff = TIFFOpen(folder.file("d.tif").c_str(), "w");
  write_page(tiff, {}, {stack_size[0], stack_size[1]}, page_of(scalars, 0, stack_size[2]));
  write_page(tiff, {}, {stack_size[1], stack_size[0]}, page_of(scalars, 1, stack_size[2]));
  TIFFClose(tiff);
  EXPECT_THAT(trouble_with(folder.file("d.tif")),
              HasSubstr("page 1 has 21 x 37 pixels of u16, where the first one has 37 x 21"));
  const TemporaryFolder empty;
  EXPECT_THAT(trouble_with(empty.file("")), HasSubstr("is a folder without slices in DICOM or TIFF files"));
}

}  // namespace
}  // namespace understudy::volume::testing
