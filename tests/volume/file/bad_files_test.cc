// SPDX-License-Identifier: Apache-2.0
// Files that are not what they claim to be cause an error that names the file and the next step, never a crash
// or a huge allocation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "tests/volume/file/volume_files.h"
#include "volume/file/file_error.h"
#include "volume/texel_box.h"

namespace understudy::volume::testing {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

TEST(BadFiles, WrongLengthsSayWhatWasExpectedAndWhatWouldFit) {
  const TemporaryFolder folder;
  const Bytes scalars = random_scalars({4, 3, 2}, ScalarType::u16, 1),
              half(scalars.begin(), scalars.begin() + 24);
  EXPECT_EQ(trouble_with(folder.write("ok_4x3x2_u16.raw", scalars)), "");
  EXPECT_THAT(
      trouble_with(folder.write("a_4x3x2_u16.raw", half)),
      AllOf(HasSubstr("a_4x3x2_u16.raw: truncated"), HasSubstr("48 bytes"), HasSubstr("(u8 would fit)")));
  EXPECT_THAT(
      trouble_with(folder.write("a_4x3x2.raw", scalars)),
      AllOf(HasSubstr("24 bytes of scalars were expected, 48 are there"), HasSubstr("u16 or i16 would fit")));
  EXPECT_THAT(trouble_with(folder.write("b_4x3x2_u16.raw.gz", gzipped(half))), HasSubstr("truncated"));
  EXPECT_THAT(trouble_with(folder.write("b_4x3x2_u8.raw.gz", gzipped(scalars))),
              HasSubstr("more than the expected"));
  Bytes cut = gzipped(scalars);
  cut.resize(cut.size() / 2);
  EXPECT_THAT(trouble_with(folder.write("c_4x3x2_u16.raw.gz", cut)), HasSubstr("truncated"));
  Bytes damaged = gzipped(random_scalars({40, 30, 20}, ScalarType::u8, 2));
  for (std::size_t i = damaged.size() / 2; i < damaged.size() / 2 + 40; ++i) damaged[i] = std::byte(0xFF);
  EXPECT_NE(trouble_with(folder.write("d_40x30x20_u8.raw.gz", damaged)), "");
  EXPECT_THAT(trouble_with(folder.write("unknown.raw", scalars)), HasSubstr("--volume-size"));
  EXPECT_THAT(trouble_with(folder.write("e_70000x1x1_u8.raw", scalars)), HasSubstr("not 1 to 16384"));
  EXPECT_THAT(trouble_with(folder.write("e_0x1x1_u8.raw", scalars)), HasSubstr("not 1 to 16384"));
  EXPECT_THAT(trouble_with(folder.write("e_4194304x2097152x2097152.raw", scalars)), HasSubstr("not 1 to 16384"))
      << "a product of 2^64";
  EXPECT_THAT(trouble_with(folder.file("missing_4x3x2.raw")), HasSubstr("check the path"));
  EXPECT_THAT(trouble_with(std::filesystem::path(folder.file("x")).parent_path()), HasSubstr("is a folder"));
}

TEST(BadFiles, NrrdHeadersThatCannotBe) {
  const TemporaryFolder folder;
  const std::string good = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n";
  const std::string data = "\n012345678901234567890123";
  EXPECT_EQ(trouble_with(folder.write("ok.nrrd", good + data)), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return trouble_with(folder.write("bad.nrrd", text + data));
  };
  EXPECT_THAT(with("4 3 2", "4 3"), HasSubstr("3 axes but 2 sizes"));
  EXPECT_THAT(with("4 3 2", "4 3 -2"), HasSubstr("not a number"));
  EXPECT_THAT(with("4 3 2", "4 3 99999999999999999999"), HasSubstr("not a number"));
  EXPECT_THAT(with("4 3 2", "16384 16384 16384"), HasSubstr("truncated"));
  EXPECT_THAT(with("dimension: 3", "dimension: 99"), HasSubstr("dimension"));
  EXPECT_THAT(with("dimension: 3\nsizes: 4 3 2", "dimension: 5\nsizes: 2 2 3 2 2"), HasSubstr("unu slice"));
  EXPECT_THAT(with("uchar", "block"), HasSubstr("unu convert"));
  EXPECT_THAT(with("raw", "bzip2"), HasSubstr("unu save"));
  EXPECT_THAT(with("uchar", "short"), HasSubstr("endian"));
  EXPECT_THAT(with("type: uchar\n", ""), HasSubstr("no field 'type'"));
  EXPECT_THAT(with("type: uchar\n", "type: uchar\ntype: int\n"), HasSubstr("twice"));
  EXPECT_THAT(with("encoding: raw\n", "encoding: raw\ndata file: LIST\n"), HasSubstr("several files"));
  EXPECT_THAT(with("encoding: raw\n", "encoding: raw\ndata file: nowhere\n"), HasSubstr("check the path"));
  EXPECT_THAT(with("encoding: raw\n", "encoding: raw\nline skip: 100\n"), HasSubstr("fewer lines"));
  std::string endless = good;
  while (endless.size() < (std::size_t(1) << 20) + 10) endless += "# a comment that goes on and on and on\n";
  EXPECT_THAT(trouble_with(folder.write("long.nrrd", endless)), HasSubstr("does not end"));
}

TEST(BadFiles, MetaImageHeadersThatCannotBe) {
  const TemporaryFolder folder;
  const std::string good =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
      "ElementDataFile = LOCAL\n";
  const std::string data = "012345678901234567890123";
  EXPECT_EQ(trouble_with(folder.write("ok.mha", good + data)), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return trouble_with(folder.write("bad.mha", text + data));
  };
  EXPECT_THAT(with("= Image", "= Tube"), HasSubstr("holds a 'Tube'"));
  EXPECT_THAT(with("BinaryData = True", "BinaryData = False"), HasSubstr("its data is text"));
  EXPECT_THAT(with("4 3 2", "4 3"), HasSubstr("3 axes but 2 sizes"));
  EXPECT_THAT(with("4 3 2", "4 3 -2"), HasSubstr("not a number"));
  EXPECT_THAT(with("4 3 2", "4 3 0"), HasSubstr("not 1 to 16384"));
  EXPECT_THAT(with("4 3 2", "16384 16384 16384"), HasSubstr("truncated"));
  EXPECT_THAT(with("NDims = 3", "NDims = 5"), HasSubstr("NDims"));
  EXPECT_THAT(with("NDims = 3\n", ""), HasSubstr("no field 'NDims'"));
  EXPECT_THAT(with("NDims = 3", "NDims = 3\nNDims = 3"), HasSubstr("twice"));
  EXPECT_THAT(with("MET_UCHAR", "MET_UCHAR_ARRAY"), HasSubstr("no scalars"));
  EXPECT_THAT(with("MET_UCHAR", "MET_UCHAR\nElementNumberOfChannels = 3"), HasSubstr("3 channels"));
  EXPECT_THAT(with("LOCAL", "LIST"), HasSubstr("several files"));
  EXPECT_THAT(with("LOCAL", "slice%03d.raw 1 2 1"), HasSubstr("several files"));
  EXPECT_THAT(with("LOCAL", "nowhere.raw"), HasSubstr("check the path"));
  EXPECT_THAT(with("ElementDataFile", "Comment"), HasSubstr("no field 'ElementDataFile'"));
  EXPECT_THAT(with("NDims", "HeaderSize = -2\nNDims"), HasSubstr("HeaderSize"));
  EXPECT_THAT(with("NDims", "CompressedData = True\nHeaderSize = -1\nNDims"), HasSubstr("HeaderSize of -1"));
  EXPECT_THAT(with("NDims", "HeaderSize = 10\nNDims"), HasSubstr("its HeaderSize is 10"));
  EXPECT_THAT(with("4 3 2\nElementType", "4 3 3\nHeaderSize = -1\nElementType"), HasSubstr("truncated"));
  EXPECT_THAT(with("NDims", "CompressedData = True\nNDims"), HasSubstr("damaged"));
  EXPECT_THAT(trouble_with(folder.write("long.mha", std::string(std::size_t(5) << 20, '='))),
              HasSubstr("does not end within"));
}

TEST(BadFiles, VtiHeadersThatCannotBe) {
  const TemporaryFolder folder;
  const std::string good =
      "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt32\">"
      "<ImageData WholeExtent=\"0 3 0 2 0 1\"><Piece Extent=\"0 3 0 2 0 1\"><PointData>"
      "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>"
      "<AppendedData encoding=\"raw\">_";
  std::string data("\x18\0\0\0", 4);
  data += "012345678901234567890123</AppendedData></VTKFile>";
  EXPECT_EQ(trouble_with(folder.write("ok.vti", good + data)), "");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return trouble_with(folder.write("bad.vti", text + data));
  };
  EXPECT_THAT(with("ImageData\" byte", "PolyData\" byte"), HasSubstr("not ImageData"));
  EXPECT_THAT(with("Extent=\"0 3 0 2 0 1\">", "Extent=\"0 3 0 2\">"), HasSubstr("six numbers"));
  EXPECT_THAT(with("<Piece Extent=\"0 3", "<Piece Extent=\"0 1"), HasSubstr("pieces"));
  EXPECT_THAT(with("type=\"UInt8\"", "type=\"String\""), HasSubstr("cannot be drawn"));
  EXPECT_THAT(with("offset=\"0\"", "offset=\"99999999\""), HasSubstr("truncated"));
  EXPECT_THAT(with("offset=\"0\"", "offset=\"-4\""), HasSubstr("not a number"));
  EXPECT_THAT(with("Name=\"a\"", "Name=\"a\" NumberOfComponents=\"3\""), HasSubstr("no scalars"));
  EXPECT_THAT(with("header_type=\"UInt32\"", "header_type=\"UInt32\" compressor=\"vtkLZ4DataCompressor\""),
              HasSubstr("ZLib"));
  EXPECT_THAT(with("header_type=\"UInt32\"", "header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\""),
              HasSubstr("blocks"));
  EXPECT_THAT(with("\"appended\" offset=\"0\"", "\"ascii\""), HasSubstr("appended or binary"));
  EXPECT_THAT(with(">_", ">x"), HasSubstr("underscore"));
  EXPECT_THAT(with("</PointData>", "</CellData>"), HasSubstr("in line"));
  EXPECT_THAT(with("WholeExtent=\"0 3 0 2 0 1\"><Piece Extent=\"0 3 0 2 0 1\"",
                   "WholeExtent=\"0 30 0 20 0 10\"><Piece Extent=\"0 30 0 20 0 10\""),
              HasSubstr("are said to have 24 bytes"));
  EXPECT_THAT(
      trouble_with(folder.write("endless.vti", "<VTKFile a=\"" + std::string(std::size_t(6) << 20, 'x'))),
      HasSubstr("a tag does not end"));
  EXPECT_THAT(trouble_with(folder.write("empty.vti", std::string())), HasSubstr("not a readable VTK image"));
}

// Files with random byte changes, mostly in headers, are read or refused with an error that names the file.
TEST(BadFiles, ChangedBytesNeverDoMoreHarmThanAnError) {
  const TemporaryFolder folder;
  const unsigned seed = 20771;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  Bytes nifti(352 + 24);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(nifti.data() + at, &value, sizeof value); };
  put(0, std::int32_t(348));
  for (const auto& [at, value] : {std::pair{40, 3}, {42, 4}, {44, 3}, {46, 2}, {70, 2}})
    put(std::size_t(at), std::int16_t(value));
  put(108, 352.0F);
  std::memcpy(nifti.data() + 344, "n+1", 4);
  const std::string blocks("\1\0\0\0\x18\0\0\0\0\0\0\0", 12);
  const Bytes packed = [] {
    const Bytes zeros(24);
    Bytes out(compressBound(24));
    uLongf length = out.size();
    compress(reinterpret_cast<Bytef*>(out.data()), &length, reinterpret_cast<const Bytef*>(zeros.data()), 24);
    out.resize(length);
    return out;
  }();
  const std::string vti =
      "<VTKFile type=\"ImageData\" header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\">"
      "<ImageData WholeExtent=\"0 3 0 2 0 1\"><Piece Extent=\"0 3 0 2 0 1\"><PointData>"
      "<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>"
      "<AppendedData encoding=\"raw\">_" +
      blocks + std::string(1, char(packed.size())) + std::string(3, '\0');
  const std::string nrrd =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: "
      "raw\nbyte skip: 0\n\n012345678901234567890123";
  const std::string meta_image =
      "ObjectType = Image\nNDims = 4\nBinaryData = True\nElementByteOrderMSB = False\nHeaderSize = -1\n"
      "ElementSpacing = 1 1 2\nDimSize = 4 3 2 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
      "012345678901234567890123";
  int survived = 0, refused = 0;
  for (const auto& [name, good] : {std::pair<std::string, Bytes>{"m.nii", nifti},
                                   {"m.mha", text_bytes(meta_image)},
                                   {"m.vti", joined(text_bytes(vti), packed)},
                                   {"m.nrrd", text_bytes(nrrd)},
                                   {"m_4x3x2.raw.gz", gzipped(Bytes(24))}}) {
    ASSERT_EQ(trouble_with(folder.write(name, good)), "") << name;
    for (int i = 0; i < 400; ++i) {
      const std::string trouble = trouble_with(folder.write(name, damaged(good, random)));
      ++(trouble.empty() ? survived : refused);
      if (!trouble.empty()) {
        if (name == "m.mha")  // its header may now name another data file
          EXPECT_THAT(trouble, AnyOf(HasSubstr(folder.file(name) + ": "), HasSubstr(": cannot be read: ")));
        else
          EXPECT_THAT(trouble, HasSubstr(folder.file(name) + ": "));
      }
    }
  }
  std::printf("%d were read, %d refused\n", survived, refused);
  EXPECT_GT(refused, 100);
  EXPECT_GT(survived, 100);
}

}  // namespace
}  // namespace understudy::volume::testing
