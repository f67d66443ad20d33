// SPDX-License-Identifier: Apache-2.0
// Every format: what was written is read back, whole and in parts, and reading a part costs no more than
// necessary.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nifti1_io.h>
#include <teem/nrrd.h>

#include <filesystem>
#include <functional>

#include "tests/volume/file/volume_files.h"
#include "volume/brick/brick_store.h"
#include "volume/description.h"
#include "volume/file/file_error.h"
#include "volume/file/raw.h"
#include "volume/kd_tree.h"
#include "volume/opening/open_volume.h"
#include "volume/texture_space.h"

namespace understudy::volume::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::array<int, 3> size{13, 7, 9};
constexpr std::array<ScalarType, 10> all_types{
    ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16, ScalarType::u32,
    ScalarType::i32, ScalarType::u64, ScalarType::i64, ScalarType::f32, ScalarType::f64};

/// Expects the file to hold these scalars: whole, in random boxes, and in slice ranges in the order of the
/// file.
void expect_holds(const std::string& name, const Bytes& scalars, ScalarType type, const FileHints& hints = {}) {
  SCOPED_TRACE(name);
  const auto file = open_volume(name, hints);
  ASSERT_EQ(file->description().size, size);
  ASSERT_EQ(file->description().type, type);
  ASSERT_EQ(read_box(*file, whole(*file)), scalars);
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const TexelBox box = random_box(size, random);
    Bytes expected(texels_in(box) * bytes_per_scalar(type));
    copy_texels(box, bytes_per_scalar(type), whole(*file), scalars, box, expected);
    EXPECT_EQ(read_box(*file, box), expected);
  }
  Bytes slice_ranges;
  for (int z = 0; z < size[2]; z += 2)
    slice_ranges =
        joined(slice_ranges, read_box(*file, {{0, 0, z}, {size[0], size[1], std::min(z + 2, size[2])}}));
  EXPECT_EQ(slice_ranges, scalars);
}

TEST(RawFile, EveryTypeAndByteOrderByNameOrByHint) {
  const TemporaryFolder folder;
  for (const ScalarType type : all_types) {
    const Bytes scalars = random_scalars(size, type, 1 + unsigned(type));
    const std::string name(name_of(type));
    expect_holds(folder.write("a_13x7x9_" + name + ".raw", scalars), scalars, type);
    const Bytes big = swapped(scalars, bytes_per_scalar(type));
    expect_holds(folder.write("b_13x7x9_" + name + "be.raw", big), scalars, type);
    expect_holds(folder.write("c_13x7x9_" + name + "be.raw.gz", gzipped(big)), scalars, type);
    expect_holds(folder.write("plain" + name, big), scalars, type, {size, type, true});
  }
  EXPECT_EQ(hints_in_name("/x/8x8x8/skull_256x255x113_int16be.raw.gz"),
            (FileHints{{{256, 255, 113}}, ScalarType::i16, true}));
  EXPECT_EQ(hints_in_name("engine.256x256x110"), (FileHints{{{256, 256, 110}}, {}, {}}));
  EXPECT_EQ(hints_in_name("tooth_103x94x161_uint16"), (FileHints{{{103, 94, 161}}, ScalarType::u16, {}}));
  EXPECT_EQ(hints_in_name("skull.raw"), FileHints{});
}

TEST(RawFile, SeveralGzipMembersAreOneFile) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::u8, 5);
  const Bytes first(scalars.begin(), scalars.begin() + 100), second(scalars.begin() + 100, scalars.end());
  expect_holds(folder.write("a_13x7x9_u8.raw.gz", joined(gzipped(first), gzipped(second))), scalars,
               ScalarType::u8);
}

// Checks by byte counts that of a plain file only the box's bytes are read.
TEST(RawFile, EachRankReadsItsShareAlone) {
  const TemporaryFolder folder;
  const std::array<int, 3> large{61, 47, 53};
  const Bytes scalars = random_scalars(large, ScalarType::u16, 7);
  const std::string name = folder.write("a_61x47x53_uint16.raw", scalars);
  VolumeDescription description;
  description.size = large;
  description.type = TexelType::u16;
  description.stored = {{0, 0, 0}, large};
  for (const int ranks : {1, 2, 4, 7}) {
    const KdTree tree(description, ranks);
    std::uint64_t sum = 0;
    for (int rank = 0; rank < ranks; ++rank) {
      const auto file = open_volume(name);
      EXPECT_LE(file->bytes_read(), 4U) << "what a format is known by";
      const std::uint64_t before = file->bytes_read();
      const TexelBox share = BrickStore::texels_shown(description, tree.box(rank));
      read_box(*file, share);
      EXPECT_EQ(file->bytes_read() - before, 2 * texels_in(share));
      sum += file->bytes_read() - before;
    }
    EXPECT_GE(sum, scalars.size());
    EXPECT_LE(double(sum), 1.35 * double(scalars.size()))
        << ranks << " ranks: the texels that neighbours share";
  }
}

struct NrrdCase {
  int type;
  ScalarType expected;
};

TEST(NrrdFile, WhatTeemWritesAttachedAndDetachedRawAndGzip) {
  const TemporaryFolder folder;
  for (const NrrdCase& c : {NrrdCase{nrrdTypeUChar, ScalarType::u8},
                            {nrrdTypeChar, ScalarType::i8},
                            {nrrdTypeUShort, ScalarType::u16},
                            {nrrdTypeShort, ScalarType::i16},
                            {nrrdTypeUInt, ScalarType::u32},
                            {nrrdTypeInt, ScalarType::i32},
                            {nrrdTypeULLong, ScalarType::u64},
                            {nrrdTypeLLong, ScalarType::i64},
                            {nrrdTypeFloat, ScalarType::f32},
                            {nrrdTypeDouble, ScalarType::f64}}) {
    Bytes scalars = random_scalars(size, c.expected, 11);
    Nrrd* nrrd = nrrdNew();
    nrrdWrap_va(nrrd, scalars.data(), c.type, 3, std::size_t(size[0]), std::size_t(size[1]),
                std::size_t(size[2]));
    nrrdAxisInfoSet_va(nrrd, nrrdAxisInfoSpacing, 0.5, 1.5, 2.5);
    for (const char* encoding : {"raw", "gzip"})
      for (const char* extension : {"nrrd", "nhdr"}) {
        NrrdIoState* state = nrrdIoStateNew();
        state->encoding = nrrdEncodingArray[airEnumVal(nrrdEncodingType, encoding)];
        const std::string name = folder.file(std::string(name_of(c.expected)) + encoding + "." + extension);
        ASSERT_EQ(nrrdSave(name.c_str(), nrrd, state), 0);
        nrrdIoStateNix(state);
        expect_holds(name, scalars, c.expected);
        EXPECT_EQ(open_volume(name)->description().spacing, (Vec3{0.5, 1.5, 2.5}));
      }
    nrrdNix(nrrd);
  }
}

TEST(NrrdFile, ForeignByteOrderSkipsAndDirections) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::i16, 13), big = swapped(scalars, 2);
  const std::string common =
      "NRRD0004\n# a comment\ntype: short\ndimension: 4\nsizes: 1 13 7 9\nendian: big\n"
      "space directions: none (0.5,0,0) (0,0,2) (0,3,4)\nkey:=value\n";
  expect_holds(folder.write("a.nrrd", joined(text_bytes(common + "encoding: raw\n\n"), big)), scalars,
               ScalarType::i16);
  EXPECT_EQ(open_volume(folder.file("a.nrrd"))->description().spacing, (Vec3{0.5, 2, 5}));
  folder.write("data", joined(text_bytes("one line\nsecond\n1234"), big));
  expect_holds(folder.write("b.nhdr", common + "encoding: raw\nline skip: 2\nbyte skip: 4\ndata file: data\n"),
               scalars, ScalarType::i16);
  expect_holds(folder.write("c.nhdr", common + "encoding: raw\nbyte skip: -1\ndata file: data\n"), scalars,
               ScalarType::i16);
  folder.write("packed", joined(text_bytes("one line\n"), gzipped(joined(text_bytes("123"), big))));
  expect_holds(folder.write("d.nhdr", common + "encoding: gzip\nline skip: 1\nbyte skip: 3\ndata file: packed"),
               scalars, ScalarType::i16);
}

/// The scalars of three time steps.
struct Steps {
  std::array<Bytes, 3> each{random_scalars(size, ScalarType::i16, 23),
                            random_scalars(size, ScalarType::i16, 29),
                            random_scalars(size, ScalarType::i16, 31)};
  Bytes all = joined(joined(each[0], each[1]), each[2]);
};

void expect_holds_steps(const std::string& name, const Steps& steps) {
  for (int step = 0; step < 3; ++step) {
    FileHints hints;
    hints.time_step = step;
    expect_holds(name, steps.each[std::size_t(step)], ScalarType::i16, hints);
    EXPECT_EQ(open_volume(name, hints)->description().time_steps, 3);
    EXPECT_EQ(open_volume(name, hints)->description().spacing, (Vec3{0.5, 1.5, 2.5}));
  }
  FileHints beyond;
  beyond.time_step = 3;
  EXPECT_THAT([&] { open_volume(name, beyond); },
              ThrowsMessage<FileError>(HasSubstr("there is no time step 3 in it; it holds 3, counted from 0")));
}

TEST(NrrdFile, TimeStepsOfALastAxis) {
  const TemporaryFolder folder;
  Steps steps;
  Nrrd* nrrd = nrrdNew();
  nrrdWrap_va(nrrd, steps.all.data(), nrrdTypeShort, 4, std::size_t(size[0]), std::size_t(size[1]),
              std::size_t(size[2]), std::size_t(3));
  nrrdAxisInfoSet_va(nrrd, nrrdAxisInfoSpacing, 0.5, 1.5, 2.5, 0.1);
  for (const char* encoding : {"raw", "gzip"})
    for (const int kind : {int(nrrdKindUnknown), int(nrrdKindTime), int(nrrdKindList)}) {
      nrrd->axis[3].kind = kind;
      NrrdIoState* state = nrrdIoStateNew();
      state->encoding = nrrdEncodingArray[airEnumVal(nrrdEncodingType, encoding)];
      const std::string name = folder.file(encoding + std::to_string(kind) + ".nrrd");
      ASSERT_EQ(nrrdSave(name.c_str(), nrrd, state), 0);
      nrrdIoStateNix(state);
      expect_holds_steps(name, steps);
    }
  nrrdNix(nrrd);
}

/// Scalars of all steps interleaved: the steps at one position, then the next position.
Bytes interleaved(const Steps& steps) {
  Bytes all;
  for (std::size_t at = 0; at < steps.each[0].size(); at += 2)
    for (const Bytes& step : steps.each) all.insert(all.end(), &step[at], &step[at] + 2);
  return all;
}

TEST(NrrdFile, TimeStepsOfAFirstAxis) {
  const TemporaryFolder folder;
  const Steps steps;
  const std::string header =
      "NRRD0004\ntype: short\nendian: little\ndimension: 4\nsizes: 3 13 7 9\nkinds: list domain domain domain\n"
      "space directions: none (0.5,0,0) (0,1.5,0) (0,0,2.5)\n";
  expect_holds_steps(
      folder.write("a.nrrd", joined(text_bytes(header + "encoding: raw\n\n"), interleaved(steps))), steps);
  expect_holds_steps(
      folder.write("b.nrrd", joined(text_bytes(header + "encoding: gzip\n\n"), gzipped(interleaved(steps)))),
      steps);
  Bytes cut = joined(text_bytes(header + "encoding: raw\n\n"), interleaved(steps));
  cut.pop_back();
  EXPECT_THAT([&] { open_volume(folder.write("c.nrrd", cut)); },
              ThrowsMessage<FileError>(HasSubstr("truncated")));
}

TEST(NrrdFile, WhatIsTimeIsSaidByKindsAndDirections) {
  const TemporaryFolder folder;
  const Steps steps;
  const auto with = [&](const std::string& fields) {
    return folder.write(
        "t.nrrd", joined(text_bytes("NRRD0004\ntype: short\nendian: little\nencoding: raw\n" + fields + "\n\n"),
                         steps.all));
  };
  const auto described = [&](const std::string& fields) { return open_volume(with(fields))->description(); };
  const std::string directions = "space directions: (0.5,0,0) (0,1.5,0) (0,0,2.5) none\ndimension: 4\n";
  expect_holds_steps(with(directions + "sizes: 13 7 9 3"), steps);
  expect_holds_steps(with(directions + "sizes: 13 7 9 3\nkinds: domain domain domain domain"), steps);
  expect_holds_steps(with("spacings: 0.5 1.5 2.5 1 1\ndimension: 5\nsizes: 13 7 9 3 1"), steps);
  // Slices over time.
  const FileDescription slices = described("dimension: 4\nsizes: 13 7 1 27\nkinds: domain domain domain time");
  EXPECT_EQ(slices.size, (std::array{13, 7, 1}));
  EXPECT_EQ(slices.time_steps, 27);
  // Without `kinds`, a long fourth axis after an axis of size 1 is not taken for time.
  EXPECT_EQ(described("dimension: 4\nsizes: 13 7 1 27").size, (std::array{13, 7, 27}));
  EXPECT_EQ(described("dimension: 3\nsizes: 13 7 27\nkinds: domain domain time").time_steps, 1);
  EXPECT_EQ(described("dimension: 4\nsizes: 1 13 7 27\nkinds: list domain domain domain").time_steps, 1);
  EXPECT_EQ(described("dimension: 4\nsizes: 1 13 7 27\nkinds: vector domain domain domain").size,
            (std::array{13, 7, 27}));
  const auto trouble = [&](const std::string& fields) -> std::string {
    try {
      described(fields);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(trouble("dimension: 4\nsizes: 13 3 7 9\nkinds: domain time domain domain"),
              HasSubstr("its axis of time is number 2 of 4; make it the last one"));
  for (const char* components : {"sizes: 13 7 9 3\nkinds: domain domain domain 3-vector",
                                 "sizes: 3 13 7 9\nkinds: RGB-color domain domain domain"})
    EXPECT_THAT(trouble(std::string("dimension: 4\n") + components),
                HasSubstr("more than three axes longer than 1"));
  EXPECT_THAT(trouble("dimension: 4\nsizes: 3 13 7 9"), HasSubstr("may be one of components, or of time"));
  EXPECT_THAT(trouble("dimension: 5\nsizes: 13 7 3 3 3"), HasSubstr("more than three axes longer than 1"));
  EXPECT_THAT(trouble("dimension: 4\nsizes: 13 7 9 100001"), HasSubstr("100001 time steps, not 1 to 100000"));
  FileHints last;
  last.time_step = 3;
  const std::string short_file = with("dimension: 4\nsizes: 13 7 9 4\nkinds: domain domain domain time");
  EXPECT_THAT(
      [&] { open_volume(short_file, last); },
      ThrowsMessage<FileError>(HasSubstr("bytes of scalars of time step 3 were expected, 0 are there")));
}

TEST(MetaImageFile, EveryTypeInOneFileAndInTwo) {
  const TemporaryFolder folder;
  for (const auto& [name, type] : {std::pair{"MET_UCHAR", ScalarType::u8},
                                   {"MET_CHAR", ScalarType::i8},
                                   {"MET_USHORT", ScalarType::u16},
                                   {"MET_SHORT", ScalarType::i16},
                                   {"MET_UINT", ScalarType::u32},
                                   {"MET_INT", ScalarType::i32},
                                   {"MET_ULONG", ScalarType::u32},
                                   {"MET_LONG", ScalarType::i32},
                                   {"MET_ULONG_LONG", ScalarType::u64},
                                   {"MET_LONG_LONG", ScalarType::i64},
                                   {"MET_FLOAT", ScalarType::f32},
                                   {"MET_DOUBLE", ScalarType::f64}}) {
    const Bytes scalars = random_scalars(size, type, 37);
    const auto header = [name = name](const std::string& more, const std::string& data) {
      return fmt::format(
          "ObjectType = Image\nNDims = 3\nBinaryData = True\n{}DimSize = 13 7 9\nElementSpacing = 0.5 1.5 2.5\n"
          "ElementType = {}\nElementDataFile = {}",
          more, name, data);
    };
    const std::string local = folder.write("a.mha", joined(text_bytes(header("", "LOCAL\n")), scalars));
    expect_holds(local, scalars, type);
    EXPECT_EQ(open_volume(local)->description().spacing, (Vec3{0.5, 1.5, 2.5}));
    folder.write("data.raw", joined(text_bytes("head"), swapped(scalars, bytes_per_scalar(type))));
    for (const char* skip :
         {"BinaryDataByteOrderMSB = True\nHeaderSize = 4\n", "ElementByteOrderMSB = True\nHeaderSize = -1\n"})
      expect_holds(folder.write("b.mhd", header(skip, "data.raw\r\n")), scalars, type);
    folder.write("data.zraw", gzipped(scalars));
    expect_holds(folder.write("c.mhd", header("CompressedData = True\n", "data.zraw\n")), scalars, type);
  }
}

TEST(MetaImageFile, TimeStepsOfTheFourthAxis) {
  const TemporaryFolder folder;
  const Steps steps;
  const std::string header =
      "ObjectType = Image\nNDims = 4\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
      "False\n"
      "ElementSpacing = 0.5 1.5 2.5 1\nDimSize = 13 7 9 3\nElementType = MET_SHORT\nElementDataFile = LOCAL\n";
  expect_holds_steps(folder.write("a.mha", joined(text_bytes(header), steps.all)), steps);
}

TEST(MetaImageFile, IsReadAsMetaIoReadsIt) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::i16, 41);
  const std::string common = "NDims = 3\nDimSize = 13 7 9\nElementType = MET_SHORT\n";
  for (const char* local : {"LOCAL\n", "Local\n", "local\r\n"})
    expect_holds(folder.write("a.mha", joined(text_bytes(common + "ElementDataFile = " + local), scalars)),
                 scalars, ScalarType::i16);
  // The header's size is counted from the beginning of the file.
  std::string padded = common + "HeaderSize = 200\nElementDataFile = LOCAL\n";
  padded.resize(200, '#');
  expect_holds(folder.write("b.mha", joined(text_bytes(padded), scalars)), scalars, ScalarType::i16);
  expect_holds(
      folder.write("c.mha", joined(text_bytes("ElementByteOrderMSB = True\nBinaryDataByteOrderMSB = False\n" +
                                              common + "ElementDataFile = LOCAL\n"),
                                   scalars)),
      scalars, ScalarType::i16);
  std::string long_header = common;
  for (int frame = 0; frame < 3000; ++frame)
    long_header += fmt::format("Seq_Frame{:04}_Timestamp = 1.5\n", frame);
  expect_holds(folder.write("d.mha", joined(text_bytes(long_header + "ElementDataFile = LOCAL\n"), scalars)),
               scalars, ScalarType::i16);
  const std::string flat =
      "NDims = 2\nDimSize = 13 7\nElementSize = 2 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  const FileDescription about =
      open_volume(folder.write("e.mha", flat + std::string(13 * 7, 'x')))->description();
  EXPECT_EQ(about.size, (std::array{13, 7, 1}));
  EXPECT_EQ(about.spacing, (Vec3{2, 3, 1}));
}

TEST(NiftiFile, TimeStepsOfTheFourthAxis) {
  const TemporaryFolder folder;
  const Steps steps;
  const std::array<int, 8> dim{4, size[0], size[1], size[2], 3, 1, 1, 1};
  for (const char* extension : {".nii", ".nii.gz", ".hdr", ".hdr.gz"}) {
    nifti_image* image = nifti_make_new_nim(dim.data(), DT_INT16, 1);
    ASSERT_NE(image, nullptr);
    image->pixdim[1] = image->dx = 0.5F;
    image->pixdim[2] = image->dy = 1.5F;
    image->pixdim[3] = image->dz = 2.5F;
    std::memcpy(image->data, steps.all.data(), steps.all.size());
    const std::string name = folder.file(std::string("a") + extension);
    ASSERT_EQ(nifti_set_filenames(image, name.c_str(), 0, 1), 0);
    nifti_image_write(image);
    nifti_image_free(image);
    expect_holds_steps(name, steps);
  }
}

TEST(NiftiFile, AxesThatAreNotThereAndAxesBehindTime) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::u8, 43);
  const auto with = [&](const std::array<std::int16_t, 8>& dim) {
    Bytes file(352);
    const std::int32_t header_bytes = 348;
    const std::array<std::int16_t, 2> type_and_bits{DT_UINT8, 8};
    const float data_offset = 352;
    std::memcpy(file.data(), &header_bytes, 4);
    std::memcpy(file.data() + 40, dim.data(), 16);
    std::memcpy(file.data() + 70, type_and_bits.data(), 4);
    std::memcpy(file.data() + 108, &data_offset, 4);
    std::memcpy(file.data() + 344, "n+1", 4);
    return folder.write("a.nii", joined(joined(file, scalars), scalars));
  };
  expect_holds(with({4, 13, 7, 9, 0, 0, 0, 0}), scalars, ScalarType::u8);
  expect_holds(with({5, 13, 7, 9, 1, 2, 1, 1}), scalars, ScalarType::u8);
  EXPECT_EQ(open_volume(folder.file("a.nii"))->description().time_steps, 1);
}

TEST(NiftiFile, WhatNiftiioWritesInOneFileAndInTwo) {
  const TemporaryFolder folder;
  for (const auto& [code, type] : {std::pair{DT_UINT8, ScalarType::u8},
                                   {DT_INT8, ScalarType::i8},
                                   {DT_UINT16, ScalarType::u16},
                                   {DT_INT16, ScalarType::i16},
                                   {DT_UINT32, ScalarType::u32},
                                   {DT_INT32, ScalarType::i32},
                                   {DT_UINT64, ScalarType::u64},
                                   {DT_INT64, ScalarType::i64},
                                   {DT_FLOAT32, ScalarType::f32},
                                   {DT_FLOAT64, ScalarType::f64}}) {
    const Bytes scalars = random_scalars(size, type, 17);
    const std::array<int, 8> dim{3, size[0], size[1], size[2], 1, 1, 1, 1};
    for (const char* extension : {".nii", ".nii.gz", ".hdr", ".hdr.gz"}) {
      nifti_image* image = nifti_make_new_nim(dim.data(), code, 1);
      ASSERT_NE(image, nullptr);
      image->pixdim[1] = image->dx = 0.5F;
      image->pixdim[2] = image->dy = 1.5F;
      image->pixdim[3] = image->dz = 2.5F;
      image->scl_slope = 2;
      image->scl_inter = -3;
      std::memcpy(image->data, scalars.data(), scalars.size());
      const std::string name = folder.file(std::string(name_of(type)) + extension);
      ASSERT_EQ(nifti_set_filenames(image, name.c_str(), 0, 1), 0);
      nifti_image_write(image);
      nifti_image_free(image);
      expect_holds(name, scalars, type);
      const FileDescription about = open_volume(name)->description();
      EXPECT_EQ(about.spacing, (Vec3{0.5, 1.5, 2.5}));
      EXPECT_EQ(about.scale, 2);
      EXPECT_EQ(about.offset, -3);
    }
  }
}

TEST(NiftiFile, ForeignByteOrderAndTheSecondVersion) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::f32, 19), big = swapped(scalars, 4);
  const auto put = [](Bytes& header, std::size_t at, auto value) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof value>>(value);
    std::ranges::reverse(raw);
    std::ranges::copy(raw, header.begin() + std::ptrdiff_t(at));
  };
  Bytes first(352);
  put(first, 0, std::int32_t(348));
  put(first, 40, std::int16_t(4));
  for (int k = 0; k < 3; ++k) put(first, 42 + 2 * std::size_t(k), std::int16_t(size[std::size_t(k)]));
  put(first, 48, std::int16_t(5));  // a series: its first volume is read
  put(first, 70, std::int16_t(16));
  put(first, 108, 352.0F);
  std::memcpy(first.data() + 344, "n+1", 4);
  expect_holds(folder.write("a.nii", joined(first, big)), scalars, ScalarType::f32);
  Bytes second(544);
  put(second, 0, std::int32_t(540));
  std::memcpy(second.data() + 4, "n+2", 4);
  put(second, 12, std::int16_t(16));
  put(second, 16, std::int64_t(3));
  for (int k = 0; k < 3; ++k) put(second, 24 + 8 * std::size_t(k), std::int64_t(size[std::size_t(k)]));
  put(second, 168, std::int64_t(544));
  expect_holds(folder.write("b.nii.gz", gzipped(joined(second, big))), scalars, ScalarType::f32);
}

std::string base64(const Bytes& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8U | (at + k < bytes.size() ? std::uint32_t(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += at + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63U];
  }
  return text;
}

struct VtiCase {
  bool appended = false;
  bool text = true;  ///< base64
  bool compressed = false;
  int length_bits = 32;
  bool big_endian = false;
  bool of_cells = false;
};

Bytes numbers(const std::vector<std::uint64_t>& values, const VtiCase& c) {
  const std::size_t width = std::size_t(c.length_bits) / 8;
  Bytes bytes;
  for (const std::uint64_t value : values)
    for (std::size_t i = 0; i < width; ++i)
      bytes.push_back(std::byte(value >> 8 * (c.big_endian ? width - 1 - i : i) & 0xFFU));
  return bytes;
}

/// Laid out as by VTK's writer.
Bytes vti(const Bytes& scalars, const std::string& type, std::size_t scalar, const VtiCase& c) {
  const Bytes stored = c.big_endian ? swapped(scalars, scalar) : scalars;
  Bytes front, data;
  if (c.compressed) {
    constexpr std::size_t block = 1000;
    const std::size_t blocks = (stored.size() + block - 1) / block;
    std::vector<std::uint64_t> lengths{blocks, block, stored.size() % block};
    for (std::size_t i = 0; i < blocks; ++i) {
      const std::size_t count = std::min(block, stored.size() - i * block);
      Bytes packed(compressBound(count));
      uLongf length = packed.size();
      compress(reinterpret_cast<Bytef*>(packed.data()), &length,
               reinterpret_cast<const Bytef*>(stored.data() + i * block), count);
      packed.resize(length);
      lengths.push_back(length);
      data = joined(data, packed);
    }
    front = numbers(lengths, c);
  } else {
    front = numbers({stored.size()}, c);
    data = stored;
  }
  Bytes body = joined(front, data);
  if (c.text) body = text_bytes(c.compressed ? base64(front) + base64(data) : base64(body));

  const int more = c.of_cells ? 0 : -1;
  std::string extent;
  for (const int axis : size) extent += "0 " + std::to_string(axis + more) + " ";
  const std::string section = c.of_cells ? "CellData" : "PointData";
  std::string head =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"" +
      std::string(c.big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"UInt" +
      std::to_string(c.length_bits) + "\"" + (c.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") +
      ">\n<ImageData WholeExtent=\"" + extent +
      "\" Origin=\"0 0 0\" Spacing=\"0.5 1.5 2.5\">\n<Piece Extent=\"" + extent + "\">\n<" + section +
      " Scalars=\"wanted\">\n<DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"3\" " +
      (c.appended ? "format=\"appended\" offset=\"0\"/>" : "format=\"binary\">AAAA</DataArray>") +
      "\n<DataArray type=\"" + type + "\" Name=\"wanted\" ";
  const std::string end = "</Piece>\n</ImageData>\n";
  if (!c.appended)
    return joined(joined(text_bytes(head + "format=\"binary\" RangeMin=\"0\">\n     "), body),
                  text_bytes("\n</DataArray>\n</" + section + ">\n" + end + "</VTKFile>\n"));
  head += "format=\"appended\" offset=\"8\"/>\n</" + section + ">\n" + end + "<AppendedData encoding=\"" +
          (c.text ? "base64" : "raw") + "\">\n  _12345678";
  return joined(joined(text_bytes(head), body), text_bytes("\n</AppendedData>\n</VTKFile>\n"));
}

TEST(VtiFile, InlineAndAppendedRawAndBase64WithAndWithoutBlocks) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::f64, 23),
              small = random_scalars(size, ScalarType::u8, 29);
  int number = 0;
  for (const bool compressed : {false, true})
    for (const int bits : {32, 64})
      for (const VtiCase& c : {VtiCase{false, true, compressed, bits},
                               {true, true, compressed, bits},
                               {true, false, compressed, bits},
                               {true, false, compressed, bits, true},
                               {false, true, compressed, bits, true, true}}) {
        const std::string stem = "v" + std::to_string(number++);
        expect_holds(folder.write(stem + ".vti", vti(scalars, "Float64", 8, c)), scalars, ScalarType::f64);
        EXPECT_EQ(open_volume(folder.file(stem + ".vti"))->description().spacing, (Vec3{0.5, 1.5, 2.5}));
        expect_holds(folder.write(stem + ".vti.gz", gzipped(vti(small, "UInt8", 1, c))), small, ScalarType::u8);
      }
}

// A compressed block outside the requested box is not read.
TEST(VtiFile, BlocksThatAreNotNeededAreNotRead) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars(size, ScalarType::f64, 31);
  const std::string name = folder.write("a.vti", vti(scalars, "Float64", 8, {true, false, true, 64}));
  const auto file = open_volume(name);
  const std::uint64_t before = file->bytes_read();
  read_box(*file, {{0, 0, 8}, {13, 7, 9}});
  EXPECT_LE(file->bytes_read() - before, 2100U) << "of " << scalars.size();
}

TEST(SyntheticVolume, BoxesAreThoseOfTheWhole) {
  for (const char* kind : {"shells", "lobes", "gyroid"})
    for (const auto& [name, type] : {std::pair<std::string, ScalarType>{"u8", ScalarType::u8},
                                     {"u16", ScalarType::u16},
                                     {"f32", ScalarType::f32}}) {
      const std::string spec = "synthetic:13x7x9:" + name + ":" + kind;
      const auto file = open_volume(spec);
      const Bytes all = read_box(*file, whole(*file));
      expect_holds(spec, all, type);
      EXPECT_NE(all, Bytes(all.size(), all.front())) << spec << " shows something";
    }
  for (const char* bad : {"synthetic:", "synthetic:8x8", "synthetic:8x8x8:i8", "synthetic:8x8x8:u8:cube",
                          "synthetic:8x8x8:u8:lobes:x", "synthetic:0x8x8", "synthetic:8x8x99999"})
    EXPECT_THROW(open_volume(bad), FileError) << bad;
}

/// A file of the folder beside the project that keeps real data, on machines that have it.
std::string real_data(const std::string& name) {
  namespace fs = std::filesystem;
  for (const char* folder : {"shared/data", "../shared/data"})
    if (const fs::path path = fs::path(UNDERSTUDY_SOURCE_DIR) / folder / name; fs::exists(path)) return path;
  return {};
}

TEST(RealVolumes, AreReadWithTheirSizesAndValues) {
  struct Expected {
    const char* name;
    std::array<int, 3> size;
    ScalarType type;
    double low, high;
  };
  int found = 0;
  for (const Expected& e : {Expected{"nucleon_41x41x41_uint8.raw.gz", {41, 41, 41}, ScalarType::u8, 0, 255},
                            {"tooth_103x94x161_uint16be.raw.gz", {103, 94, 161}, ScalarType::u16, 0, 1400},
                            {"viscous_run01/density_003.vti", {64, 64, 64}, ScalarType::f32, 0, 79},
                            {"isabel/isabel_30.vti.gz", {125, 125, 25}, ScalarType::f64, 0, 90}}) {
    const std::string path = real_data(e.name);
    if (path.empty()) continue;
    ++found;
    const auto file = open_volume(path);
    EXPECT_EQ(file->description().size, e.size) << e.name;
    ASSERT_EQ(file->description().type, e.type) << e.name;
    const Bytes bytes = read_box(*file, whole(*file));
    double low = 1e300, high = -1e300;
    const auto look = [&](auto scalar) {
      for (std::size_t at = 0; at < bytes.size(); at += sizeof scalar) {
        std::memcpy(&scalar, bytes.data() + at, sizeof scalar);
        low = std::min(low, double(scalar));
        high = std::max(high, double(scalar));
      }
    };
    if (e.type == ScalarType::u8) look(std::uint8_t{});
    if (e.type == ScalarType::u16) look(std::uint16_t{});
    if (e.type == ScalarType::f32) look(float{});
    if (e.type == ScalarType::f64) look(double{});
    std::printf("%s: %g to %g\n", e.name, low, high);
    EXPECT_GE(low, e.low) << e.name;
    EXPECT_LE(high, e.high) << e.name;
    EXPECT_GT(high - low, (e.high - e.low) / 3) << e.name;
  }
  if (found == 0) GTEST_SKIP() << "shared/data is not here";
}

}  // namespace
}  // namespace understudy::volume::testing
