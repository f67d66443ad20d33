// SPDX-License-Identifier: Apache-2.0
// DICOM series: slices are placed by their position in the patient, and have the values that the scanner
// measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "tests/volume/file/dicom_files.h"
#include "volume/file/file_error.h"
#include "volume/file/readable_files.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/slices/slice_folder.h"
#include "volume/opening/open_volume.h"

namespace understudy::volume::testing {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::array<int, 3> series_size{13, 7, 9};

Bytes slice_of(const Bytes& scalars, int z) {
  const std::size_t bytes = scalars.size() / std::size_t(series_size[2]);
  const auto first = scalars.begin() + std::ptrdiff_t(bytes) * z;
  return {first, first + std::ptrdiff_t(bytes)};
}

/// Slice z of `scalars`, 2.5 mm after the previous one along `normal`.
DicomFile slice_file(const Bytes& scalars, int z, const Vec3& normal = {0, 0, 1}) {
  DicomFile file;
  file.instance = series_size[2] - z;  // instance numbers may decrease
  for (std::size_t k = 0; k < 3; ++k) file.position[k] = 100 + 2.5 * z * normal[k];
  file.pixels = slice_of(scalars, z);
  return file;
}

void write_series(const TemporaryFolder& folder, const Bytes& scalars, ScalarType type) {
  for (int z = 0; z < series_size[2]; ++z) {
    DicomFile file = slice_file(scalars, z);
    file.type = type;
    folder.write("IM" + std::to_string((z * 5) % series_size[2]), dicom_bytes(file));
  }
}

/// Options of gdcmconv, and the transfer syntax that each produces.
constexpr std::array<std::pair<const char*, const char*>, 5> syntaxes{{{"--implicit", "1.2.840.10008.1.2"},
                                                                       {"--rle", "1.2.840.10008.1.2.5"},
                                                                       {"--jpeg", "1.2.840.10008.1.2.4.70"},
                                                                       {"--jpegls", "1.2.840.10008.1.2.4.80"},
                                                                       {"--j2k", "1.2.840.10008.1.2.4.90"}}};

std::string text_in(const TemporaryFolder& folder, const std::string& name) {
  const Bytes bytes = folder.read(name);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(DicomSeries, SlicesLieInTheOrderOfTheirPositions) {
  for (const ScalarType type : {ScalarType::u8, ScalarType::i8, ScalarType::u16, ScalarType::i16}) {
    const TemporaryFolder folder;
    const Bytes scalars = random_scalars(series_size, type, 5);
    write_series(folder, scalars, type);
    folder.write("notes.txt", "not DICOM");
    for (const std::string& name : {folder.file(""), folder.file("IM0")}) {
      const auto file = open_volume(name);
      ASSERT_EQ(file->description().size, series_size);
      EXPECT_EQ(file->description().type, type);
      EXPECT_THAT(file->description().spacing,
                  ElementsAre(DoubleNear(0.25, 1e-9), DoubleNear(0.5, 1e-9), DoubleNear(2.5, 1e-9)));
      EXPECT_EQ(read_box(*file, whole(*file)), scalars);
      const TexelBox box{{2, 1, 3}, {11, 6, 8}};
      Bytes expected(texels_in(box) * bytes_per_scalar(type));
      copy_texels(box, bytes_per_scalar(type), whole(*file), scalars, box, expected);
      EXPECT_EQ(read_box(*file, box), expected);
      EXPECT_GT(file->bytes_read(), scalars.size());
    }
  }
}

TEST(DicomSeries, EveryCompressionOfScannersAndArchives) {
  for (const auto& [option, syntax] : syntaxes) {
    SCOPED_TRACE(option);
    const TemporaryFolder folder, packed;
    const Bytes scalars = random_scalars(series_size, ScalarType::u16, 6);
    for (int z = 0; z < series_size[2]; ++z) {
      DicomFile file = slice_file(scalars, z);
      file.type = ScalarType::u16;
      const std::string plain = folder.write(std::to_string(z) + ".dcm", dicom_bytes(file));
      recompress(plain, packed.file(std::to_string(z) + ".dcm"), option);
      ASSERT_THAT(text_in(packed, std::to_string(z) + ".dcm"), HasSubstr(syntax));
    }
    const auto file = open_volume(packed.file(""));
    ASSERT_EQ(file->description().size, series_size);
    EXPECT_EQ(read_box(*file, whole(*file)), scalars);
  }
}

/// Signed 12-bit values in 16 bits: the bits above them are not part of the value.
TEST(DicomSeries, BitsBeyondThoseStoredAreNotRead) {
  const TemporaryFolder folder;
  DicomFile file;
  file.size = {4, 1};
  file.stored_bits = 12;
  file.pixels = bytes_of(std::vector<std::uint16_t>{0x0001, 0x07FF, 0x0800, 0xFFFF});
  folder.write("a.dcm", dicom_bytes(file));
  const auto volume = open_volume(folder.file("a.dcm"));
  EXPECT_EQ(read_box(*volume, whole(*volume)), bytes_of(std::vector<std::int16_t>{1, 2047, -2048, -1}));
}

TEST(DicomSeries, ValuesAreThoseOfTheModality) {
  const TemporaryFolder same, different;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 7);
  for (int z = 0; z < series_size[2]; ++z) {
    DicomFile file = slice_file(scalars, z);
    file.slope = 2;
    file.intercept = -1024;
    same.write(std::to_string(z), dicom_bytes(file));
    file.slope = 1 + z;  // as in PET
    different.write(std::to_string(z), dicom_bytes(file));
  }
  const auto hounsfield = open_volume(same.file(""));
  EXPECT_EQ(hounsfield->description().type, ScalarType::i16);
  EXPECT_EQ(hounsfield->description().scale, 2);
  EXPECT_EQ(hounsfield->description().offset, -1024);
  const auto values = open_volume(different.file(""));
  ASSERT_EQ(values->description().type, ScalarType::f32);
  const Bytes read = read_box(*values, whole(*values));
  for (std::size_t i = 0; i < scalars.size() / 2; ++i) {
    std::int16_t stored = 0;
    float value = 0;
    std::memcpy(&stored, scalars.data() + 2 * i, 2);
    std::memcpy(&value, read.data() + 4 * i, 4);
    const std::size_t z = i / std::size_t(series_size[0] * series_size[1]);
    ASSERT_EQ(value, float((1.0 + double(z)) * stored - 1024));
  }
}

TEST(DicomSeries, SeveralImagesOfAPlaceAreTimeSteps) {
  const TemporaryFolder folder;
  const std::array<Bytes, 3> steps{random_scalars(series_size, ScalarType::i16, 1),
                                   random_scalars(series_size, ScalarType::i16, 2),
                                   random_scalars(series_size, ScalarType::i16, 3)};
  for (int z = 0; z < series_size[2]; ++z)
    for (int t = 0; t < 3; ++t) {
      DicomFile file = slice_file(steps[std::size_t(t)], z);
      file.position[2] += 0.001 * ((z + t) % 2);  // rounding of scanners
      file.instance = 100 * t + z;
      folder.write(std::to_string(7 * z + t), dicom_bytes(file));
    }
  for (int t = 0; t < 3; ++t) {
    const auto file = open_volume(folder.file(""), at_step(t));
    EXPECT_EQ(file->description().time_steps, 3);
    EXPECT_EQ(read_box(*file, whole(*file)), steps[std::size_t(t)]);
  }
  EXPECT_THAT(trouble_with(folder.file(""), at_step(3)),
              HasSubstr("there is no time step 3 in it; it holds 3"));
  std::filesystem::remove(folder.file("8"));
  EXPECT_THAT(trouble_with(folder.file("")), HasSubstr("images lie where it lies"));
}

TEST(DicomSeries, TimeStepsComeByTemporalPositionBeforeTheirNumbers) {
  const TemporaryFolder folder;
  const std::array<Bytes, 2> steps{random_scalars(series_size, ScalarType::i16, 1),
                                   random_scalars(series_size, ScalarType::i16, 2)};
  for (int z = 0; z < series_size[2]; ++z)
    for (int t = 0; t < 2; ++t) {
      DicomFile file = slice_file(steps[std::size_t(t)], z);
      file.instance = z % 2 == t ? 1 : 2;  // numbered separately in each acquisition
      file.more[{0x20, 0x100}] = dicom::element(0x20, 0x100, "IS", std::to_string(t + 1));
      folder.write(std::to_string(2 * z + t), dicom_bytes(file));
    }
  for (int t = 0; t < 2; ++t) {
    const auto file = open_volume(folder.file(""), at_step(t));
    EXPECT_EQ(file->description().time_steps, 2);
    EXPECT_EQ(read_box(*file, whole(*file)), steps[std::size_t(t)]);
  }
}

TEST(DicomSeries, SlicesOfSmallThingsLieClose) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 3);
  for (int z = 0; z < series_size[2]; ++z) {
    DicomFile file = slice_file(scalars, z);
    file.position = {0, 0, 0.008 * z};
    file.pixel_spacing = {0.008, 0.008};
    folder.write(std::to_string(z), dicom_bytes(file));
  }
  const auto file = open_volume(folder.file(""));
  ASSERT_EQ(file->description().size, series_size);
  EXPECT_NEAR(file->description().spacing[2], 0.008, 1e-9);
  EXPECT_EQ(read_box(*file, whole(*file)), scalars);
}

TEST(DicomSeries, FramesOfADoseLieByTheirOffsets) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::u16, 4);
  DicomFile file;
  file.type = ScalarType::u16;
  std::vector<double> offsets;
  for (int z = series_size[2] - 1; z >= 0; --z) {  // from the head downwards
    file.pixels = joined(file.pixels, slice_of(scalars, z));
    offsets.push_back(3.0 * (z + 1 - series_size[2]));
  }
  file.more[{0x28, 8}] = dicom::element(0x28, 8, "IS", std::to_string(series_size[2]));
  file.more[{0x28, 0x1052}] = file.more[{0x28, 0x1053}] = "";
  file.more[{0x3004, 0xC}] = dicom::element(0x3004, 0xC, "DS", dicom::text_of(offsets));
  file.more[{0x3004, 0xE}] = dicom::element(0x3004, 0xE, "DS", "0.5");
  folder.write("dose.dcm", dicom_bytes(file));
  const auto volume = open_volume(folder.file("dose.dcm"));
  ASSERT_EQ(volume->description().size, series_size);
  EXPECT_NEAR(volume->description().spacing[2], 3, 1e-9);
  EXPECT_EQ(volume->description().scale, 0.5);
  EXPECT_EQ(read_box(*volume, whole(*volume)), scalars);
}

TEST(DicomSeries, FramesThatFollowInTimeAreTimeSteps) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 4);
  DicomFile file;
  file.position.clear();
  file.pixels = scalars;
  file.more[{0x28, 8}] = dicom::element(0x28, 8, "IS", std::to_string(series_size[2]));
  const std::string at_frame_time = dicom::little(0x18, 2) + dicom::little(0x1063, 2);
  file.more[{0x28, 9}] = dicom::element(0x28, 9, "AT", at_frame_time);
  folder.write("cine.dcm", dicom_bytes(file));
  const auto volume = open_volume(folder.file("cine.dcm"), at_step(4));
  EXPECT_EQ(volume->description().time_steps, series_size[2]);
  EXPECT_EQ(volume->description().size[2], 1);
  EXPECT_EQ(read_box(*volume, whole(*volume)), slice_of(scalars, 4));
}

TEST(DicomSeries, FilesWithoutAPreambleAreKnownByTheirName) {
  const TemporaryFolder folder;
  DicomFile file;
  file.pixels = random_scalars({13, 7, 1}, ScalarType::i16, 5);
  const std::string whole_file = dicom_bytes(file);
  const std::size_t first = whole_file.find(std::string("\x08\0\x16\0", 4));
  folder.write("old.dcm", whole_file.substr(first));
  const auto volume = open_volume(folder.file("old.dcm"));
  EXPECT_EQ(read_box(*volume, whole(*volume)), file.pixels);
}

TEST(DicomSeries, FramesOfOneFileLieWhereTheyLie) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 8);
  DicomFile file;
  file.slope = 3;
  file.intercept = -7;
  file.orientation = {0, 1, 0, 0, 0, 1};  // slices are stacked along x
  for (int i = 0; i < series_size[2]; ++i) {
    const int z = (i * 4) % series_size[2];
    file.frame_positions.push_back({2.5 * z, 4, 5});
    file.pixels = joined(file.pixels, slice_of(scalars, z));
  }
  folder.write("enhanced.dcm", dicom_bytes(file));
  const auto volume = open_volume(folder.file("enhanced.dcm"));
  ASSERT_EQ(volume->description().size, series_size);
  EXPECT_NEAR(volume->description().spacing[2], 2.5, 1e-9);
  EXPECT_EQ(volume->description().scale, 3);
  EXPECT_EQ(read_box(*volume, whole(*volume)), scalars);
  file.pixels.resize(file.pixels.size() - 40);
  EXPECT_THAT(trouble_with(folder.write("enhanced.dcm", dicom_bytes(file))),
              HasSubstr("its pixels cannot be decoded"));
}

TEST(DicomSeries, FramesOfOneFileInEveryCompression) {
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 8);
  DicomFile file;
  file.stored_bits = 12;  // with a sign that extends into the bits above
  Bytes expected;
  for (std::size_t i = 0; i < scalars.size(); i += 2) {
    std::int16_t value = 0;
    std::memcpy(&value, scalars.data() + i, 2);
    value = std::int16_t(value >> 4);
    expected = joined(expected, bytes_of(std::vector{value}));
  }
  file.pixels = expected;
  for (int z = 0; z < series_size[2]; ++z) file.frame_positions.push_back({0, 0, 2.5 * z});
  const TemporaryFolder folder;
  const std::string plain = folder.write("plain.dcm", dicom_bytes(file));
  for (const auto& [option, syntax] : syntaxes) {
    SCOPED_TRACE(option);
    const TemporaryFolder packed;
    recompress(plain, packed.file("a.dcm"), option);
    ASSERT_THAT(text_in(packed, "a.dcm"), HasSubstr(syntax));
    const auto volume = open_volume(packed.file("a.dcm"));
    EXPECT_EQ(read_box(*volume, whole(*volume)), expected);
    EXPECT_EQ(read_box(*volume, {{2, 1, 4}, {3, 2, 5}}).size(), 2);
  }
}

TEST(DicomSeries, OneOfSeveralIsChosenByAFileOfIt) {
  const TemporaryFolder folder;
  const Bytes head = random_scalars(series_size, ScalarType::i16, 1),
              chest = random_scalars(series_size, ScalarType::i16, 2);
  for (int z = 0; z < series_size[2]; ++z) {
    folder.write("head" + std::to_string(z), dicom_bytes(slice_file(head, z)));
    DicomFile other = slice_file(chest, z, {0, 0, -1});
    other.series += ".2";
    folder.write("chest" + std::to_string(z), dicom_bytes(other));
  }
  DicomFile report;
  report.series += ".3";
  report.samples = 3;
  report.meaning = "RGB";
  report.type = ScalarType::u8;
  report.pixels.resize(3 * 13 * 7 + 1);
  folder.write("report", dicom_bytes(report));
  EXPECT_THAT(
      trouble_with(folder.file("")),
      AllOf(HasSubstr("images of 3 series lie in this folder; give a file of the one that is meant"),
            HasSubstr("series 4 'head', 9 files: " + folder.file("chest0")), HasSubstr(folder.file("head0"))));
  const auto file = open_volume(folder.file("head4"));
  EXPECT_EQ(read_box(*file, whole(*file)), head);
  EXPECT_THAT(trouble_with(folder.file("report")), HasSubstr("its pixels are colours (RGB)"));
}

TEST(DicomSeries, WhatIsNoVolumeSaysWhy) {
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 9);
  const auto with_last = [&](const DicomFile& last) {
    const TemporaryFolder folder;
    for (int z = 0; z + 1 < series_size[2]; ++z)
      folder.write(std::to_string(z), dicom_bytes(slice_file(scalars, z)));
    folder.write("8", dicom_bytes(last));
    return trouble_with(folder.file(""));
  };
  DicomFile last = slice_file(scalars, 8);
  EXPECT_EQ(with_last(last), "");
  last.position[2] += 2.5;
  EXPECT_THAT(with_last(last), HasSubstr("it lies 5 mm behind 7, where other slices lie 2.5 mm apart"));
  last = slice_file(scalars, 8);
  last.size = {7, 13};
  EXPECT_THAT(with_last(last), HasSubstr("8: DICOM: it has 7 x 13 pixels of i16, where 0 has 13 x 7"));
  last = slice_file(scalars, 8);
  for (const std::vector<double>& turned : {std::vector<double>{0, 1, 0, 0, 0, 1}, {-1, 0, 0, 0, -1, 0}}) {
    last.orientation = turned;
    EXPECT_THAT(with_last(last), HasSubstr("another plane than"));
  }
  last = slice_file(scalars, 8);
  last.pixel_spacing = {0.5, 0.5};
  EXPECT_THAT(with_last(last), HasSubstr("put images of one reconstruction into a folder of their own"));
  last = slice_file(scalars, 8);
  last.position[0] += 2;
  EXPECT_THAT(with_last(last), HasSubstr("its rows begin 2 mm beside those of 0: the gantry was tilted"));
  last = slice_file(scalars, 7);
  last.image = "1.2.3";
  EXPECT_THAT(with_last(last), HasSubstr("images lie where it lies"));
  last = slice_file(scalars, 8);
  last.more[{8, 8}] = dicom::element(8, 8, "CS", "ORIGINAL\\PRIMARY\\M\\MOSAIC");
  EXPECT_THAT(with_last(last), HasSubstr("MOSAIC"));
  last = slice_file(scalars, 8);
  last.more[{0x28, 0x3000}] = dicom::sequence(0x28, 0x3000, {});
  EXPECT_THAT(with_last(last), HasSubstr("Modality LUT"));
  last = slice_file(scalars, 8);
  last = slice_file(scalars, 8);
  last.meaning = "RGB";
  last.samples = 3;
  EXPECT_THAT(with_last(last), HasSubstr("its pixels are colours (RGB)"));
  last = slice_file(scalars, 8);
  last.pixels.resize(100);
  EXPECT_THAT(with_last(last), HasSubstr("8: DICOM: its pixels cannot be decoded"));
  const TemporaryFolder folder;
  std::string cut = dicom_bytes(slice_file(scalars, 8));
  cut.resize(cut.size() - 10);
  EXPECT_THAT(trouble_with(folder.write("cut.dcm", cut)), HasSubstr("its pixels cannot be decoded"));
}

/// Files with random byte changes are read or refused with an error.
TEST(DicomSeries, ChangedBytesNeverDoMoreHarmThanAnError) {
  const TemporaryFolder folder;
  DicomFile file;
  file.type = ScalarType::u16;
  file.pixels = slice_of(random_scalars(series_size, ScalarType::u16, 1), 0);
  const std::string plain = folder.write("plain", dicom_bytes(file));
  std::mt19937 random(20772);
  int survived = 0, refused = 0;
  for (const char* const option : {"--explicit", "--rle", "--jpeg", "--jpegls", "--j2k"}) {
    recompress(plain, folder.file("packed"), option);
    const Bytes good = folder.read("packed");
    for (int i = 0; i < 200; ++i) {
      const TemporaryFolder alone;
      const std::string trouble = trouble_with(alone.write("m.dcm", damaged(good, random)));
      ++(trouble.empty() ? survived : refused);
      if (!trouble.empty()) {
        EXPECT_THAT(trouble, HasSubstr(std::filesystem::path(alone.file("")).parent_path().string()));
      }
    }
  }
  std::printf("%d were read, %d refused\n", survived, refused);
  EXPECT_GT(refused, 100);
  EXPECT_GT(survived, 100);
}

TEST(DicomSeries, EveryFileTwiceIsNoTimeSeries) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 9);
  for (int z = 0; z < series_size[2]; ++z)
    for (const char* const copy : {"a", "b"})
      folder.write(copy + std::to_string(z), dicom_bytes(slice_file(scalars, z)));
  EXPECT_THAT(trouble_with(folder.file("")), HasSubstr("nothing says which of them comes first"));
}

/// Parsing each level would take a part of the stack.
TEST(DicomSeries, DeepSequencesAreRefused) {
  const TemporaryFolder folder;
  DicomFile file;
  file.pixels.resize(2 * 13 * 7);
  for (const bool with_length : {false, true}) {
    std::string nested;
    if (with_length) {
      for (int i = 0; i < 2000; ++i) nested = dicom::sequence(8, 0x1140, {nested});
    } else {
      using dicom::little;
      for (int i = 0; i < 100'000; ++i)
        nested += little(8, 2) + little(0x1140, 2) + "SQ" + little(0, 2) + little(0xFFFFFFFF, 4) +
                  little(0xFFFE, 2) + little(0xE000, 2) + little(0xFFFFFFFF, 4);
    }
    file.more.clear();
    file.more[{8, 0x1140}] = nested;
    EXPECT_THAT(trouble_with(folder.write("a.dcm", dicom_bytes(file))),
                HasSubstr("sequences more than 32 deep"));
  }
}

TEST(DicomSeries, WhatLiesBehindThePixelsIsNotRead) {
  const TemporaryFolder folder;
  DicomFile file;
  file.pixels = random_scalars({13, 7, 1}, ScalarType::i16, 5);
  using dicom::little;
  std::string nested;
  for (int i = 0; i < 100'000; ++i)
    nested += little(0xFFFA, 2) + little(0xFFFA, 2) + "SQ" + little(0, 2) + little(0xFFFFFFFF, 4) +
              little(0xFFFE, 2) + little(0xE000, 2) + little(0xFFFFFFFF, 4);
  folder.write("a.dcm", dicom_bytes(file) + nested);
  const auto volume = open_volume(folder.file("a.dcm"));
  EXPECT_EQ(read_box(*volume, whole(*volume)), file.pixels);
}

TEST(DicomSeries, ElementsOfNoTypeAreRefused) {
  const TemporaryFolder folder;
  DicomFile file;
  file.pixels.resize(2 * 13 * 7);
  for (const std::string& type : {std::string("ZZ"), std::string("\1\0", 2)}) {
    file.more[{8, 0x1140}] = dicom::little(8, 2) + dicom::little(0x1140, 2) + type + std::string("\0\x10", 2);
    EXPECT_THAT(trouble_with(folder.write("a.dcm", dicom_bytes(file))), HasSubstr("elements of no type"));
  }
}

/// Direction cosines with three digits, as some scanners write them, and rows displaced by less than half a
/// pixel.
TEST(DicomSeries, DirectionsAndPositionsMayBeRounded) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 3);
  for (int z = 0; z < series_size[2]; ++z) {
    DicomFile file = slice_file(scalars, z, {0.707, -0.707, 0});
    file.orientation = {0.707, 0.707, 0, 0, 0, -1};
    file.position[2] += 0.1 * (z % 2);
    folder.write(std::to_string(z), dicom_bytes(file));
  }
  const auto file = open_volume(folder.file(""));
  EXPECT_EQ(file->description().size, series_size);
}

TEST(DicomSeries, StepsThatMeanTheirValuesDifferentlyAreAllFloats) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 3);
  for (int z = 0; z < series_size[2]; ++z)
    for (int t = 0; t < 2; ++t) {
      DicomFile file = slice_file(scalars, z);
      file.slope = 1 + t;
      file.instance = 100 * t + z;
      folder.write(std::to_string(2 * z + t), dicom_bytes(file));
    }
  for (int t = 0; t < 2; ++t) {
    const auto file = open_volume(folder.file(""), at_step(t));
    ASSERT_EQ(file->description().type, ScalarType::f32);
    std::int16_t stored = 0;
    float value = 0;
    std::memcpy(&stored, scalars.data(), 2);
    std::memcpy(&value, read_box(*file, {{0, 0, 0}, {1, 1, 1}}).data(), 4);
    EXPECT_EQ(value, float((1 + t) * stored));
  }
}

/// DCMTK would decode these into memory of the wrong size.
TEST(DicomSeries, JpegImagesOfAnotherSizeOrDepthAreRefused) {
  const TemporaryFolder folder, alone;
  DicomFile file;
  file.type = ScalarType::u16;
  file.pixels = random_scalars({13, 7, 1}, ScalarType::u16, 6);
  recompress(folder.write("plain", dicom_bytes(file)), folder.file("a.dcm"), "--jpeg");
  const std::string good = text_in(folder, "a.dcm");
  const std::size_t frame = good.find("\xFF\xC3");
  ASSERT_NE(frame, std::string::npos);
  for (const auto& [offset, value] : {std::pair{4, 8}, {6, 9}, {8, 12}, {9, 3}}) {
    std::string other = good;
    other[frame + std::size_t(offset)] = char(value);
    EXPECT_THAT(trouble_with(alone.write("a.dcm", other)), HasSubstr("its JPEG image is one of"));
  }
  recompress(folder.file("plain"), alone.file("a.dcm"), "--deflated");
  EXPECT_THAT(trouble_with(alone.file("a.dcm")), HasSubstr("it is deflated, which is not read"));
}

TEST(DicomHeaders, FilesAreParsedAgainWhereTheyChanged) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 6);
  write_series(folder, scalars, ScalarType::i16);
  std::vector<std::string> files = files_in_folder(folder.file(""));
  DicomHeaders known;
  const auto first = known.of(files, {});
  ASSERT_EQ(first.size(), std::size_t(series_size[2]));
  EXPECT_EQ(known.of(files, {}), first);
  DicomFile other = slice_file(scalars, 2);
  other.slope = 3;
  const std::string name = std::filesystem::path(files[2]).filename();
  folder.write(name, dicom_bytes(other));
  std::filesystem::last_write_time(files[2],
                                   std::filesystem::last_write_time(files[1]) + std::chrono::seconds(1));
  const auto second = known.of(files, {});
  ASSERT_EQ(second.size(), first.size());
  EXPECT_EQ(second[2]->frames.front().slope, 3);
  for (const std::size_t same : {0, 1, 3}) EXPECT_EQ(second[same], first[same]);
  // Headers that a call does not request are dropped.
  known.of(std::span(files).first(1), {});
  const auto third = known.of(files, {});
  EXPECT_EQ(third[0], first[0]);
  EXPECT_NE(third[1], first[1]);
  std::filesystem::remove(files[1]);
  EXPECT_THROW(known.of(files, {}), FileError);
}

TEST(DicomSeries, FoldersAreReadOnlyWhereClientsMay) {
  const TemporaryFolder allowed, other;
  const Bytes scalars = random_scalars(series_size, ScalarType::i16, 9);
  write_series(allowed, scalars, ScalarType::i16);
  write_series(other, scalars, ScalarType::i16);
  const std::string parent = std::filesystem::path(allowed.file("")).parent_path();
  const ReadableFiles files(std::span(&parent, 1));
  EXPECT_EQ(trouble_with(parent, {}, files), "");
  EXPECT_EQ(trouble_with(parent + "/", {}, files), "");
  EXPECT_EQ(trouble_with(parent + "/IM1", {}, files), "");
  EXPECT_THAT(trouble_with(other.file(""), {}, files), HasSubstr("lies in none of the folders"));
  std::filesystem::create_directory_symlink(other.file(""), allowed.file("link"));
  EXPECT_THAT(trouble_with(allowed.file("link"), {}, files), HasSubstr("lies in none of the folders"));
}

}  // namespace
}  // namespace understudy::volume::testing
