// SPDX-License-Identifier: Apache-2.0
// Samples as a driver rounds them that filters 8-bit texels in 8 bits.
#include "spu/volume/classification/sample_rounding.h"

#include <gtest/gtest.h>

namespace understudy::spu {
namespace {

/// Opaque above the middle.
volume::TransferFunction step() {
  volume::TransferFunction table;
  for (int i = 0; i < 4081; ++i) table.entries.push_back(i > 2040 ? volume::Rgba{1, 1, 1, 1} : volume::Rgba{});
  return table;
}

float alpha_at(const volume::TransferFunction& table, double value) {
  const double place = (value - table.low) / (table.high - table.low) * double(table.entries.size() - 1);
  return table.entries[std::size_t(place + 0.5)][3];
}

TEST(RoundedSamples, HaveTheColourOfTheNearestWholeValue) {
  const volume::TransferFunction rounded = with_rounded_samples(step());
  EXPECT_EQ(alpha_at(rounded, 127.4 / 255), 0);
  EXPECT_EQ(alpha_at(rounded, 127.6 / 255), 1);  // 127.6 is shown as 128 is
  EXPECT_EQ(alpha_at(rounded, 129.0 / 255), 1);
}

TEST(RoundedSamples, OfPartOfTheRangeBeginAndEndWithIt) {
  volume::TransferFunction part = step();
  part.low = 0.25F;
  part.high = 0.5F;
  const volume::TransferFunction rounded = with_rounded_samples(part);
  EXPECT_EQ(rounded.low, 0.25F);
  EXPECT_EQ(rounded.high, 0.5F);
  EXPECT_EQ(alpha_at(rounded, 0.25), 0);
  EXPECT_EQ(alpha_at(rounded, 0.5), 1);
}

TEST(SampleRounding, IsTriedOnceAndKeptWhereItWins) {
  const TextureDescription bytes;
  SampleRounding rounding;
  EXPECT_FALSE(rounding.rounds());
  EXPECT_TRUE(rounding.try_after_loss(bytes));
  EXPECT_TRUE(rounding.rounds());
  rounding.won();
  EXPECT_FALSE(rounding.try_after_loss(bytes));
  EXPECT_TRUE(rounding.rounds());
}

TEST(SampleRounding, IsGivenUpWhereItLosesToo) {
  const TextureDescription bytes;
  SampleRounding rounding;
  EXPECT_TRUE(rounding.try_after_loss(bytes));
  EXPECT_FALSE(rounding.try_after_loss(bytes));
  EXPECT_FALSE(rounding.rounds());
  EXPECT_FALSE(rounding.try_after_loss(bytes));
}

TEST(SampleRounding, IsNoMatterOfFloatsOrOfNearestTexels) {
  TextureDescription floats;
  floats.type = volume::TexelType::f32;
  TextureDescription nearest;
  nearest.filter = volume::Filter::nearest;
  EXPECT_FALSE(SampleRounding().try_after_loss(floats));
  EXPECT_FALSE(SampleRounding().try_after_loss(nearest));
}

}  // namespace
}  // namespace understudy::spu
