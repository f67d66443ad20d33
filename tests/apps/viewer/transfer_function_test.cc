// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace viewer {
namespace {

TEST(TransferFunction, PresetsAreFoundByNameAndByNumber) {
  ASSERT_EQ(presets().size(), 5U);
  for (std::size_t i = 0; i < presets().size(); ++i) {
    EXPECT_EQ(find_preset(presets()[i].name), &presets()[i]);
    EXPECT_EQ(find_preset(std::to_string(i + 1)), &presets()[i]);
  }
  for (const char* unknown : {"", "0", "6", "-1", "1x", "99999999999999999999999", "Engine"})
    EXPECT_EQ(find_preset(unknown), nullptr) << unknown;
}

TEST(TransferFunction, PresetsStateOpacitiesAndColoursInRange) {
  for (const Preset& preset : presets()) {
    EXPECT_EQ(preset.points.front().value, 0) << preset.name;
    EXPECT_EQ(preset.points.back().value, 1) << preset.name;
    for (std::size_t i = 0; i < preset.points.size(); ++i) {
      const ControlPoint& p = preset.points[i];
      for (const double x : {p.red, p.green, p.blue, p.opacity}) EXPECT_TRUE(x >= 0 && x <= 1) << preset.name;
      if (i > 0) {
        EXPECT_GE(p.value, preset.points[i - 1].value) << preset.name;
      }
    }
  }
}

TEST(TransferFunction, OpacityCorrectionKeepsTheOpacityOfAWholePath) {
  // Two slices at half the reference distance absorb as much as one at the reference distance.
  for (const Preset& preset : presets()) {
    const Table whole = make_table(preset, 1.0, false), half = make_table(preset, 0.5, false);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const double passed = 1 - half[i][3] / 255.0;
      EXPECT_NEAR(1 - passed * passed, whole[i][3] / 255.0, 2.0 / 255) << preset.name << " entry " << i;
      for (int channel = 0; channel < 3; ++channel) EXPECT_EQ(whole[i][channel], half[i][channel]);
    }
  }
}

TEST(TransferFunction, OpaqueStaysOpaqueAtAnySpacing) {
  const Table table = make_table(*find_preset("step"), 1e-3, false);
  EXPECT_EQ(table[255][3], 255);
  EXPECT_EQ(table[0][3], 0);
}

TEST(TransferFunction, DenseHasNoEmptyValueUnlessZeroStandsForNoValue) {
  const Preset& dense = *find_preset("dense");
  for (const Rgba8& entry : make_table(dense, 1, false)) EXPECT_GT(entry[3], 0);
  const Table with_hole = make_table(dense, 1, true);
  EXPECT_EQ(with_hole[0][3], 0);
  EXPECT_GT(with_hole[1][3], 0);
}

TEST(TransferFunction, LookUpMeetsEntriesAndInterpolatesBetween) {
  const Table table = make_table(*find_preset("engine"), 1, false);
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(look_up(table, static_cast<double>(i) / 255), table[i]);
  const Rgba8 between = look_up(table, 120.5 / 255);
  for (int channel = 0; channel < 4; ++channel)
    EXPECT_NEAR(between[channel], 0.5 * (table[120][channel] + table[121][channel]), 0.5 + 1e-9);
  EXPECT_EQ(look_up(table, -3), table[0]);
  EXPECT_EQ(look_up(table, 7), table[255]);
}

}  // namespace
}  // namespace viewer
