// SPDX-License-Identifier: Apache-2.0
// Samples as rounded by a driver that filters 8-bit texels with 8 bits.
#include "spu/volume/classification/sample_rounding.h"

#include <gtest/gtest.h>

#include "volume/request.h"

namespace understudy::spu {
namespace {

TEST(RoundedSamples, AreAskedForWhereTheyAreClassifiedOneByOne) {
  volume::RenderRequest samples;
  round_samples(samples);
  EXPECT_EQ(samples.filter, volume::Filter::linear_8_bit);

  volume::RenderRequest adaptive;
  adaptive.method = volume::Method::adaptive;
  volume::RenderRequest colours;
  colours.classification = volume::LinearMap{};
  volume::RenderRequest nearest;
  nearest.filter = volume::Filter::nearest;
  for (volume::RenderRequest request : {adaptive, colours, nearest}) {
    const volume::Filter filter = request.filter;
    round_samples(request);
    EXPECT_EQ(request.filter, filter);
  }
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

TEST(SampleRounding, IsNoMatterOfFloatsOfNearestTexelsOrOfBorders) {
  TextureDescription floats;
  floats.type = volume::TexelType::f32;
  TextureDescription nearest;
  nearest.filter = volume::Filter::nearest;
  EXPECT_FALSE(SampleRounding().try_after_loss(floats));
  EXPECT_FALSE(SampleRounding().try_after_loss(nearest));
  TextureDescription bordered;
  bordered.wrap[1] = volume::Wrap::border;
  EXPECT_FALSE(SampleRounding().try_after_loss(bordered));
}

}  // namespace
}  // namespace understudy::spu
