// SPDX-License-Identifier: Apache-2.0
// The value range over which a transfer function is measured.
#include "spu/volume/texture/value_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "spu/volume/texture/texels.h"

namespace understudy::spu {
namespace {

using volume::TexelType;

constexpr float infinite = std::numeric_limits<float>::infinity();

TextureDescription words() {
  TextureDescription texture;
  texture.type = TexelType::u16;
  texture.steps = 65535;
  return texture;
}

TextureDescription signed_words() {
  TextureDescription texture;
  texture.type = TexelType::f32;
  texture.held = {-1, 1};
  texture.steps = 32767;
  return texture;
}

/// Distance of the value `stored` / steps from the nearest measured entry, in entries.
double distance_to_entry(std::array<float, 2> range, int steps, int stored) {
  const double place =
      (double(stored) / steps - range[0]) / (double(range[1]) - range[0]) * (probed_entries - 1);
  return std::abs(place - std::round(place));
}

TEST(ValueRange, OfBytesIsWhole) {
  EXPECT_EQ(value_range(TextureDescription{}, {0.25F, 0.5F}), (std::array{0.0F, 1.0F}));
}

TEST(ValueRange, HasEveryValueOfAScannerOnAnEntry) {
  for (const auto& [texture, low, high] : {std::tuple{words(), 0, 1300},
                                           {words(), 777, 777},
                                           {words(), 65535, 65535},
                                           {words(), 31000, 33500},
                                           {words(), 62000, 65535},
                                           {words(), 0, 3000},
                                           {signed_words(), -1024, 2000},
                                           {signed_words(), -32767, -32000},
                                           {signed_words(), 32767, 32767},
                                           {signed_words(), -5, 5}}) {
    const auto steps = float(texture.steps);
    const auto range = value_range(texture, {float(low) / steps, float(high) / steps});
    EXPECT_LE(range[0], float(low) / steps);
    EXPECT_GE(range[1], float(high) / steps);
    EXPECT_GE(range[0], texture.held[0]);
    EXPECT_LE(range[1], texture.held[1]);
    EXPECT_LT(range[0], range[1]);
    for (int stored = low; stored <= high; ++stored)
      ASSERT_LT(distance_to_entry(range, texture.steps, stored), 5e-3)
          << low << " to " << high << ": " << stored;
  }
}

TEST(ValueRange, OfSignedBytesHasThemAllOnEntries) {
  TextureDescription texture = signed_words();
  texture.steps = 127;
  const auto range = value_range(texture, {-1, 1});
  for (int stored = -127; stored <= 127; ++stored)
    EXPECT_LT(distance_to_entry(range, 127, stored), 2e-3) << stored;
}

TEST(ValueRange, OfManyValuesHoldsThem) {
  const auto range = value_range(words(), {0, 40000.0F / 65535});
  EXPECT_EQ(range[0], 0);
  EXPECT_GE(range[1], 40000.0F / 65535);
  EXPECT_EQ(value_range(words(), {0, 1}), (std::array{0.0F, 1.0F}));
  EXPECT_EQ(value_range(signed_words(), {-1, 1}), (std::array{-1.0F, 1.0F}));
}

TEST(TableEntries, HoldEveryValueThatTheNearestFilterShows) {
  for (TextureDescription texture : {words(), signed_words()}) {
    texture.filter = volume::Filter::nearest;
    for (const auto& texels : {std::array{0.0F, 1.0F}, {0.0F, 40000.0F / 65535}, {0.25F, 0.26F}}) {
      const auto range = value_range(texture, texels);
      const int entries = table_entries(texture, range);
      EXPECT_GE(entries, probed_entries);
      EXPECT_LE(entries, 65536);
      EXPECT_FALSE(may_lie_between_entries(texture, range, entries));
    }
    EXPECT_TRUE(may_lie_between_entries(texture, texture.held, probed_entries));
  }
}

TEST(TableEntries, AreFewWhereSamplesAreInterpolated) {
  EXPECT_EQ(table_entries(words(), {0, 1}), probed_entries);
  EXPECT_FALSE(may_lie_between_entries(words(), {0, 1}, probed_entries));
}

TEST(TableEntries, CannotHoldAllFloats) {
  TextureDescription texture;
  texture.type = TexelType::f32;
  texture.filter = volume::Filter::nearest;
  texture.steps = 0;
  EXPECT_EQ(table_entries(texture, {0, 1}), probed_entries);
  EXPECT_TRUE(may_lie_between_entries(texture, {0, 1}, probed_entries));
}

TEST(TableEntries, HoldBytesInTablesOfSlicesAndOfRays) {
  TextureDescription texture;
  texture.filter = volume::Filter::nearest;
  for (const int entries : {probed_entries, probed_entries_of_rays})
    EXPECT_FALSE(may_lie_between_entries(texture, {0, 1}, entries));
}

TEST(ValueRange, StaysWhereAFieldChangesALittle) {
  const auto before = value_range(words(), {100.0F / 65535, 3000.0F / 65535});
  EXPECT_EQ(value_range(words(), {120.0F / 65535, 2900.0F / 65535}), before);
}

TEST(ValueRange, OfFloatsIsTheirsAndTheBordersThatShows) {
  TextureDescription texture;
  texture.type = TexelType::f32;
  texture.held = {-infinite, infinite};
  texture.steps = 0;
  EXPECT_EQ(value_range(texture, {-3, 9}), (std::array{-3.0F, 9.0F}));
  EXPECT_EQ(value_range(texture, {2, 2}), (std::array{2.0F, 4.0F}));
  EXPECT_EQ(value_range(texture, {1, 0}), (std::array{0.0F, 1.0F})) << "no finite texel";
  texture.wrap = {volume::Wrap::edge, volume::Wrap::border, volume::Wrap::edge};
  texture.border = {-7, 0, 0, 0};
  EXPECT_EQ(value_range(texture, {-3, 9}), (std::array{-7.0F, 9.0F}));
}

}  // namespace
}  // namespace understudy::spu
