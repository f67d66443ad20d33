// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/texels.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace viewer {
namespace {

template <typename T>
Volume row(ScalarType type, const std::vector<T>& values) {
  Volume volume;
  volume.file = "row";
  volume.size = {static_cast<std::int64_t>(values.size()), 1, 1};
  volume.type = type;
  volume.voxels.resize(values.size() * sizeof(T));
  std::memcpy(volume.voxels.data(), values.data(), volume.voxels.size());
  return volume;
}

TEST(Texels, BytesStayAsTheyAre) {
  const Texels texels = to_texels(row<std::uint8_t>(ScalarType::u8, {7, 0, 100}));
  EXPECT_EQ(texels.format, TexelFormat::unorm8);
  EXPECT_EQ(texel_value(texels, 0), 7 / 255.0);
  EXPECT_EQ(texels.value_at_1, 255);
  EXPECT_EQ(texels.highest, 100);
}

TEST(Texels, OtherIntegersAreSpreadOverSixteenBits) {
  const Texels shorts = to_texels(row<std::int16_t>(ScalarType::i16, {-1000, 3000, 0, -32768, 32767}));
  EXPECT_EQ(shorts.format, TexelFormat::unorm16);
  EXPECT_EQ(shorts.value_at_0, -32768);
  EXPECT_EQ(texel_value(shorts, 3), 0);
  EXPECT_EQ(texel_value(shorts, 4), 1);
  EXPECT_NEAR(texel_value(shorts, 0), (-1000 + 32768) / 65535.0, 1e-9);

  const Texels narrow = to_texels(row<std::uint16_t>(ScalarType::u16, {500, 510, 505}));
  EXPECT_EQ(texel_value(narrow, 0), 0);
  EXPECT_EQ(texel_value(narrow, 1), 1);
  EXPECT_NEAR(texel_value(narrow, 2), 0.5, 1e-5);

  const Texels bytes = to_texels(row<std::int8_t>(ScalarType::i8, {-128, 127}));
  EXPECT_EQ(texel_value(bytes, 0), 0);
  EXPECT_EQ(texel_value(bytes, 1), 1);
}

TEST(Texels, NotFiniteFloatsAreCountedAndBecomeZero) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                  infinite = std::numeric_limits<float>::infinity();
  const Texels texels = to_texels(row<float>(ScalarType::f32, {nan, 2, -2, infinite, 0, -infinite}));
  EXPECT_EQ(texels.not_finite, 3);
  EXPECT_EQ(texels.value_at_0, -2);
  EXPECT_EQ(texels.value_at_1, 2);
  const double expected[] = {0, 1, 0, 0, 0.5, 0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(texel_value(texels, i), expected[i]) << i;
}

TEST(Texels, AVolumeWithoutRangeOrWithoutNumbersIsZero) {
  EXPECT_EQ(texel_value(to_texels(row<float>(ScalarType::f32, {5, 5})), 1), 0);
  EXPECT_EQ(texel_value(to_texels(row<std::int16_t>(ScalarType::i16, {-3, -3})), 0), 0);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Texels empty = to_texels(row<float>(ScalarType::f32, {nan, nan}));
  EXPECT_EQ(empty.not_finite, 2);
  EXPECT_EQ(texel_value(empty, 0), 0);
}

}  // namespace
}  // namespace viewer
