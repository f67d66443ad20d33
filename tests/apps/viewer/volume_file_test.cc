// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/volume_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "apps/viewer/formats/raw.h"
#include "apps/viewer/model/error.h"
#include "tests/apps/viewer/temporary_folder.h"

namespace viewer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using viewer_test::TemporaryFolder;

template <typename T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

template <typename T>
std::vector<T> values_of(const Volume& volume) {
  std::vector<T> values(volume.voxels.size() / sizeof(T));
  std::memcpy(values.data(), volume.voxels.data(), volume.voxels.size());
  return values;
}

std::vector<std::uint8_t> counting(std::size_t count) {
  std::vector<std::uint8_t> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<std::uint8_t>(i);
  return values;
}

std::string compressed(const TemporaryFolder& folder, const std::string& name,
                       const std::vector<std::byte>& bytes) {
  const gzFile file = gzopen(folder.file(name).c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  return folder.file(name);
}

std::string message_of(const std::string& path, const VolumeHints& hints = {}) {
  try {
    load_volume(path, hints);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_file);
    EXPECT_THAT(error.what(), HasSubstr(path)) << "a message says where";
    return error.what();
  }
  return "(loaded)";
}

// A NIfTI-1 header for a single file, 2x3x4 voxels.
nifti_1_header nifti_header(short datatype, short bits) {
  nifti_1_header header{};
  header.sizeof_hdr = sizeof header;
  header.dim[0] = 3;
  header.dim[1] = 2;
  header.dim[2] = 3;
  header.dim[3] = 4;
  for (int i = 4; i < 8; ++i) header.dim[i] = 1;
  header.pixdim[1] = 1.5F;
  header.pixdim[2] = 2.5F;
  header.pixdim[3] = 3.5F;
  header.datatype = datatype;
  header.bitpix = bits;
  header.vox_offset = 352;
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

std::vector<std::byte> nifti_file(const nifti_1_header& header, const std::vector<std::byte>& voxels) {
  std::vector<std::byte> file(352 + voxels.size());
  std::memcpy(file.data(), &header, sizeof header);
  std::copy(voxels.begin(), voxels.end(), file.begin() + 352);
  return file;
}

TEST(RawFile, SizeAndTypeComeFromTheName) {
  const TemporaryFolder folder;
  const std::string path = folder.write("thing.4x3x2", bytes_of(counting(24)));
  const Volume volume = load_volume(path, {});
  EXPECT_EQ(volume.size, (VolumeSize{4, 3, 2}));
  EXPECT_EQ(volume.type, ScalarType::u8);
  EXPECT_EQ(volume.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(values_of<std::uint8_t>(volume), counting(24));

  const auto layout = layout_in_name("/some/12x12/skull_256x255x113_uint16.raw");
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->size, (VolumeSize{256, 255, 113}));
  EXPECT_EQ(layout->type, ScalarType::u16);
  EXPECT_FALSE(layout_in_name("skull.raw"));
  EXPECT_FALSE(layout_in_name("skull.256x256.raw"));
}

TEST(RawFile, HintsWinOverTheName) {
  const TemporaryFolder folder;
  const std::string path = folder.write("thing.4x3x2", bytes_of(counting(24)));
  VolumeHints hints;
  hints.size = VolumeSize{2, 3, 2};
  hints.type = ScalarType::u16;
  hints.big_endian = true;
  hints.spacing = Vec3{1, 2, 3};
  const Volume volume = load_volume(path, hints);
  EXPECT_EQ(volume.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(values_of<std::uint16_t>(volume)[1], 0x0203);
}

TEST(RawFile, GzipIsTransparent) {
  const TemporaryFolder folder;
  const std::string path = compressed(folder, "thing.4x3x2.raw.gz", bytes_of(counting(24)));
  EXPECT_EQ(values_of<std::uint8_t>(load_volume(path, {})), counting(24));
}

TEST(RawFile, PlainVoxelsThatLookLikeGzipAreNotDecompressed) {
  const TemporaryFolder folder;
  std::vector<std::uint8_t> voxels = counting(24);
  voxels[0] = 0x1f;
  voxels[1] = 0x8b;
  voxels[2] = 8;
  EXPECT_EQ(values_of<std::uint8_t>(load_volume(folder.write("thing.4x3x2", bytes_of(voxels)), {})), voxels);
}

TEST(RawFile, WrongLengthsSayExpectedAndFoundBytes) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of(folder.write("short.4x3x2", bytes_of(counting(23)))),
              AllOf(HasSubstr("truncated"), HasSubstr("expected 24 bytes, found 23")));
  EXPECT_THAT(message_of(folder.write("empty.4x3x2", std::string())), HasSubstr("expected 24 bytes, found 0"));
  EXPECT_THAT(message_of(folder.write("long.4x3x2", bytes_of(counting(48)))),
              AllOf(HasSubstr("disagree"), HasSubstr("expected 24 bytes, found 48"), HasSubstr("--type u16")));
  EXPECT_THAT(message_of(compressed(folder, "short.4x3x2.gz", bytes_of(counting(20)))),
              HasSubstr("expected 24 bytes, found 20"));
  EXPECT_THAT(message_of(compressed(folder, "long.4x3x2.gz", bytes_of(counting(25)))),
              AllOf(HasSubstr("disagree"), HasSubstr("expected 24 bytes, found more")));
}

TEST(RawFile, DamagedGzipIsAnError) {
  const TemporaryFolder folder;
  const std::string path = compressed(folder, "thing.32x32x32.gz", bytes_of(counting(32768)));
  const auto length = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, length / 2);
  EXPECT_THAT(message_of(path), HasSubstr("truncated: expected 32768 bytes"));
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(20);
  file << std::string(20, '\xff');
  file.close();
  EXPECT_THAT(message_of(path), testing::AnyOf(HasSubstr("cannot be read"), HasSubstr("truncated")));
}

TEST(RawFile, SizesOutOfRangeAreRefusedBeforeReading) {
  const TemporaryFolder folder;
  const std::string path = folder.write("thing.raw", bytes_of(counting(24)));
  EXPECT_THAT(message_of(path), HasSubstr("--size X Y Z"));
  const auto with_size = [&](VolumeSize size, ScalarType type = ScalarType::u8) {
    VolumeHints hints;
    hints.size = size;
    hints.type = type;
    return message_of(path, hints);
  };
  EXPECT_THAT(with_size({0, 3, 2}), HasSubstr("contains no voxels"));
  EXPECT_THAT(with_size({4, -3, 2}), HasSubstr("contains no voxels"));
  EXPECT_THAT(with_size({max_edge_voxels, 1, 1}), HasSubstr("truncated"));
  EXPECT_THAT(with_size({max_edge_voxels + 1, 1, 1}), HasSubstr("limit of 65536"));
  EXPECT_THAT(with_size({max_edge_voxels, max_edge_voxels, 64}), HasSubstr("truncated"));
  EXPECT_THAT(with_size({max_edge_voxels, max_edge_voxels, 65}), HasSubstr("above the limit"));
  EXPECT_THAT(with_size({std::numeric_limits<std::int64_t>::max(), 2, 2}), HasSubstr("limit of 65536"));
}

TEST(VolumeFile, MissingFilesAndFoldersAreErrors) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of(folder.file("absent.4x4x4")), HasSubstr("no such file"));
  EXPECT_THAT(message_of(folder.file("")), HasSubstr("is a folder"));
}

TEST(VolumeFile, SpacingMustBePositiveAndFinite) {
  const TemporaryFolder folder;
  const std::string path = folder.write("thing.4x3x2", bytes_of(counting(24)));
  for (const double bad :
       {0.0, 1e-31, 1e31, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    VolumeHints hints;
    hints.spacing = Vec3{1, bad, 1};
    EXPECT_THAT(message_of(path, hints), HasSubstr("spacing"));
  }
}

TEST(NrrdFile, SizeTypeAndSpacingComeFromTheHeader) {
  const TemporaryFolder folder;
  const std::string header =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 3\nspacings: 1 2 0.5\nendian: big\nencoding: raw\n\n";
  const std::string path = folder.write("a.nrrd", header + std::string("\0\1\0\2\0\3\0\4\0\5\xff\xff", 12));
  const Volume volume = load_volume(path, {});
  EXPECT_EQ(volume.size, (VolumeSize{2, 1, 3}));
  EXPECT_EQ(volume.type, ScalarType::i16);
  EXPECT_EQ(volume.spacing, (Vec3{1, 2, 0.5}));
  EXPECT_EQ(values_of<std::int16_t>(volume), (std::vector<std::int16_t>{1, 2, 3, 4, 5, -1}));
}

TEST(NrrdFile, AxesOfLengthOneDoNotCountAndDoublesBecomeFloats) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.nrrd",
      "NRRD0004\ntype: double\ndimension: 4\nsizes: 1 2 2 2\nencoding: ascii\n\n0.5 1 2 3 4 5 6 nan\n");
  const Volume volume = load_volume(path, {});
  EXPECT_EQ(volume.size, (VolumeSize{2, 2, 2}));
  EXPECT_EQ(volume.type, ScalarType::f32);
  EXPECT_EQ(values_of<float>(volume)[0], 0.5F);
  EXPECT_TRUE(std::isnan(values_of<float>(volume)[7]));
}

TEST(NrrdFile, DamagedHeadersAndMissingVoxelsAreErrors) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) { return message_of(folder.write("bad.nrrd", text)); };
  EXPECT_THAT(message("NRRD0004\ngarbage\n"), HasSubstr("not a readable NRRD file"));
  EXPECT_THAT(message("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\nabc"),
              AllOf(HasSubstr("not a readable NRRD file"), HasSubstr("64")));
  EXPECT_THAT(message("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 0 4 4\nencoding: raw\n\nabc"),
              HasSubstr("NRRD"));
  EXPECT_THAT(message("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 90000 90000 4\nencoding: raw\n\nabc"),
              HasSubstr("limit of 65536"));
  EXPECT_THAT(
      message("NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 2 2\nencoding: raw\n\n" + std::string(24, 'x')),
      HasSubstr("a scalar volume has 3"));
}

TEST(NiftiFile, SizeTypeSpacingAndVoxelsAreRead) {
  const TemporaryFolder folder;
  const std::vector<std::byte> file = nifti_file(nifti_header(DT_UINT8, 8), bytes_of(counting(24)));
  for (const std::string& path : {folder.write("a.nii", file), compressed(folder, "b.nii.gz", file)}) {
    const Volume volume = load_volume(path, {});
    EXPECT_EQ(volume.size, (VolumeSize{2, 3, 4}));
    EXPECT_EQ(volume.type, ScalarType::u8);
    EXPECT_EQ(volume.spacing, (Vec3{1.5, 2.5, 3.5}));
    EXPECT_EQ(values_of<std::uint8_t>(volume), counting(24));
  }
}

TEST(NiftiFile, SlopeAndInterceptAreAppliedAndNaNIsKept) {
  const TemporaryFolder folder;
  nifti_1_header header = nifti_header(DT_UINT8, 8);
  header.scl_slope = 2;
  header.scl_inter = -10;
  const Volume scaled = load_volume(folder.write("a.nii", nifti_file(header, bytes_of(counting(24)))), {});
  EXPECT_EQ(scaled.type, ScalarType::f32);
  EXPECT_EQ(values_of<float>(scaled)[3], -4.0F);

  std::vector<float> floats(24, 1.0F);
  floats[5] = std::numeric_limits<float>::quiet_NaN();
  const Volume holed =
      load_volume(folder.write("b.nii", nifti_file(nifti_header(DT_FLOAT32, 32), bytes_of(floats))), {});
  EXPECT_TRUE(std::isnan(values_of<float>(holed)[5]));
}

TEST(NiftiFile, TruncatedDamagedAndColourFilesAreErrors) {
  const TemporaryFolder folder;
  const nifti_1_header header = nifti_header(DT_INT16, 16);
  EXPECT_THAT(message_of(folder.write("a.nii", nifti_file(header, bytes_of(counting(24))))),
              HasSubstr("expected 400 bytes, found 376"));
  EXPECT_THAT(message_of(folder.write("b.nii", std::string("x"))), HasSubstr("not a readable NIfTI-1 file"));
  EXPECT_THAT(message_of(folder.write("c.nii", nifti_file(nifti_header(DT_RGB24, 24), bytes_of(counting(72))))),
              HasSubstr("not scalars"));
}

}  // namespace
}  // namespace viewer
