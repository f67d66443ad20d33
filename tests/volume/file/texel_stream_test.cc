// SPDX-License-Identifier: Apache-2.0
// Conversion from scalars to texels is exact where possible; elsewhere the error is reported.
#include "volume/file/texel_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/volume/file/volume_files.h"
#include "volume/brick/brick_store.h"
#include "volume/file/file_error.h"
#include "volume/opening/open_volume.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::volume::testing {
namespace {

struct Result {
  TexelMapping mapping;
  TexelFigures figures;
  Bytes texels;

  template <typename Texel>
  double value(std::size_t i) const {
    Texel texel;
    std::memcpy(&texel, texels.data() + i * sizeof texel, sizeof texel);
    return mapping.offset + mapping.scale * double(texel);
  }
};

Result streamed(const std::string& name, const TexelChoice& choice = {}, std::size_t at_once = 100) {
  auto file = open_volume(name);
  const TexelBox box = whole(*file);
  TexelStream stream(std::move(file), choice, box);
  Result result;
  int z = 0;
  while (!stream.done()) {
    const TexelStream::SliceSegment slice_range = stream.next(at_once);
    EXPECT_EQ(slice_range.box.low[2], z);
    z = slice_range.box.high[2];
    result.texels.insert(result.texels.end(), slice_range.texels.begin(), slice_range.texels.end());
    EXPECT_EQ(stream.texels_done() * bytes_per_texel(stream.mapping().type), result.texels.size());
  }
  EXPECT_EQ(z, box.high[2]);
  EXPECT_EQ(stream.texels_done(), stream.texels_in_all());
  result.mapping = stream.mapping();
  result.figures = stream.figures();
  return result;
}

template <typename T>
std::string written(const TemporaryFolder& folder, const std::string& type, const std::vector<T>& values) {
  return folder.write("v_" + std::to_string(values.size() / 2) + "x1x2_" + type + ".raw", bytes_of(values));
}

TEST(TexelStream, ACompressedFileIsPassedOverInParts) {
  const TemporaryFolder folder;
  const std::array<int, 3> size{13, 7, 200};
  const Bytes scalars = random_scalars(size, ScalarType::u8, 5);
  const TexelBox box{{0, 0, 150}, size};
  for (const auto& [name, bytes] :
       {std::pair{"a_13x7x200.raw.gz", gzipped(scalars)}, {"b_13x7x200.raw", scalars}}) {
    const std::string path = folder.write(name, bytes);
    TexelStream stream(open_volume(path), {}, box);
    int calls = 1;
    while (!stream.approach(500)) ++calls;
    EXPECT_EQ(calls, path.ends_with(".gz") ? 28 : 1) << "150 slices of 91 bytes each";
    Bytes texels;
    while (!stream.done()) {
      EXPECT_TRUE(stream.approach(500));
      const TexelStream::SliceSegment slices = stream.next(1000);
      texels.insert(texels.end(), slices.texels.begin(), slices.texels.end());
    }
    EXPECT_TRUE(stream.approach(500));
    EXPECT_TRUE(std::ranges::equal(texels, std::span(scalars).subspan(150 * 91)));
  }
  // Reading a truncated file reports the truncation.
  Bytes cut = gzipped(scalars);
  cut.resize(cut.size() / 2);
  TexelStream stream(open_volume(folder.write("c_13x7x200.raw.gz", cut)), {}, box);
  while (!stream.approach(500)) {
  }
  EXPECT_THAT([&] { stream.next(1000); },
              ::testing::ThrowsMessage<FileError>(::testing::HasSubstr("truncated")));
}

TEST(TexelStream, NarrowIntegersAreExact) {
  const TemporaryFolder folder;
  const std::vector<std::int16_t> wide{-32768, -1, 0, 1, 1234, 32767};
  const Result shorts = streamed(written(folder, "i16", wide));
  EXPECT_EQ(shorts.mapping.type, TexelType::u16);
  for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_EQ(shorts.value<std::uint16_t>(i), wide[i]);
  EXPECT_EQ(shorts.figures.low, -32768);
  EXPECT_EQ(shorts.figures.high, 32767);
  EXPECT_EQ(shorts.figures.largest_error, 0);
  EXPECT_EQ(shorts.mapping.normalised(32767), 1);
  EXPECT_EQ(shorts.mapping.normalised(-32768), 0);

  const std::vector<std::int8_t> narrow{-128, -1, 0, 127};
  const Result chars = streamed(written(folder, "i8", narrow));
  EXPECT_EQ(chars.mapping.type, TexelType::u8);
  for (std::size_t i = 0; i < narrow.size(); ++i) EXPECT_EQ(chars.value<std::uint8_t>(i), narrow[i]);
  EXPECT_EQ(chars.figures.largest_error, 0);

  const std::vector<std::uint8_t> bytes{3, 255, 0, 77};
  const Result same = streamed(written(folder, "u8", bytes));
  EXPECT_EQ(same.texels, bytes_of(bytes));
  EXPECT_EQ(same.figures.low, 0);
  EXPECT_EQ(same.figures.high, 255);
}

TEST(TexelStream, WideTypesBecomeFloatsAndTheErrorIsTold) {
  const TemporaryFolder folder;
  const std::vector<double> values{1.0 / 3, -1e6 / 7, 2, 1e300, 0.1, -5};
  const Result doubles = streamed(written(folder, "f64", values));
  EXPECT_EQ(doubles.mapping.type, TexelType::f32);
  EXPECT_NEAR(doubles.figures.largest_error, 1e300, 1e290) << "beyond what floats hold";
  EXPECT_TRUE(std::isfinite(doubles.value<float>(3)));

  const std::vector<std::uint64_t> integers{0, 1, (std::uint64_t(1) << 40) + 12345, 7};
  const Result longs = streamed(written(folder, "u64", integers));
  double worst = 0;
  for (std::size_t i = 0; i < integers.size(); ++i)
    worst = std::max(worst, std::abs(double(integers[i]) - longs.value<float>(i)));
  EXPECT_GT(worst, 1000);
  EXPECT_EQ(longs.figures.largest_error, worst);

  const std::vector<std::int32_t> exact{-5, 1 << 24, 0, 3};
  EXPECT_EQ(streamed(written(folder, "i32", exact)).figures.largest_error, 0);
}

TEST(TexelStream, ARangeIsSpreadOverTheTexelsAndTheErrorIsHalfOfOne) {
  const TemporaryFolder folder;
  std::vector<double> values(2000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = -3 + 10.0 * double(i) / 1999;
  const std::string name = written(folder, "f64", values);
  for (const TexelType type : {TexelType::u8, TexelType::u16}) {
    const Result result = streamed(name, {type, {{-3, 7}}});
    const double top = type == TexelType::u8 ? 255 : 65535;
    EXPECT_LE(result.figures.largest_error, 10 / top / 2 * 1.0001);
    EXPECT_GT(result.figures.largest_error, 10 / top / 4);
    for (std::size_t i = 0; i < values.size(); i += 97)
      EXPECT_NEAR(type == TexelType::u8 ? result.value<std::uint8_t>(i) : result.value<std::uint16_t>(i),
                  values[i], result.figures.largest_error * 1.0001);
  }
  EXPECT_EQ(streamed(name, {{}, {{-3, 7}}}).mapping.type, TexelType::u16) << "a range asks for integers";
  const Result clamped = streamed(name, {TexelType::u8, {{0, 1}}});
  EXPECT_NEAR(clamped.figures.largest_error, 6, 1e-9) << "what lies outside counts";
  EXPECT_EQ(clamped.figures.high, 7);
  EXPECT_THROW(streamed(name, {TexelType::u8, {}}), FileError);
  EXPECT_THROW(streamed(name, {TexelType::u8, {{1, 1}}}), FileError);
  EXPECT_THROW(streamed(name, {TexelType::u8, {{2, 1}}}), FileError);
  EXPECT_THROW(streamed(name, {TexelType::u8, {{0, std::nan("")}}}), FileError);
  EXPECT_THROW(streamed(name, {TexelType::rgba8, {}}), FileError);
}

TEST(TexelStream, WhatIsNoNumberIsCountedAndStaysNone) {
  const TemporaryFolder folder;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> values{1, std::nanf(""), 2, infinity, std::nanf(""), -1};
  const std::string name = written(folder, "f32", values);
  const Result floats = streamed(name);
  EXPECT_EQ(floats.figures.not_numbers, 2U);
  EXPECT_TRUE(std::isnan(floats.value<float>(1)));
  EXPECT_EQ(floats.figures.low, -1);
  EXPECT_EQ(floats.figures.high, 2) << "infinity is not the end of a range";
  EXPECT_EQ(floats.value<float>(3), BrickStore::largest_value);
  const Result bytes = streamed(name, {TexelType::u8, {{-1, 2}}});
  EXPECT_EQ(bytes.figures.not_numbers, 2U);
  EXPECT_EQ(bytes.value<std::uint8_t>(1), -1) << "the least texel";
  EXPECT_EQ(bytes.value<std::uint8_t>(3), 2) << "the greatest";
  const Result none = streamed(written(folder, "f32", std::vector<float>{-infinity, infinity}));
  EXPECT_GT(none.figures.low, none.figures.high);
  EXPECT_EQ(none.value<float>(0), -BrickStore::largest_value);
}

}  // namespace
}  // namespace understudy::volume::testing
