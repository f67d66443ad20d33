// SPDX-License-Identifier: Apache-2.0
// A transfer function that is corrected for another sample distance describes the same medium.
#include "volume/opacity_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace understudy::volume::testing {
namespace {

Rgba at(const TransferFunction& function, double place) {
  const double entry = place * double(function.entries.size() - 1);
  const auto below = std::min(std::size_t(entry), function.entries.size() - 2);
  Rgba value{};
  for (std::size_t k = 0; k < 4; ++k)
    value[k] =
        std::lerp(function.entries[below][k], function.entries[below + 1][k], float(entry - double(below)));
  return value;
}

TransferFunction spike() {
  return {0.25F, 0.75F, {{0, 0, 0, 0}, {0.3F, 0.15F, 0, 0.6F}, {0, 0, 0, 0}, {0.1F, 0.2F, 0.3F, 0}}};
}

TEST(OpacityCorrection, LayersOfAnyThicknessComposeToOne) {
  for (const double step : {0.125, 0.5, 2.0, 8.0}) {
    const TransferFunction corrected = opacity_corrected(spike(), step, 4096);
    EXPECT_EQ(corrected.low, 0.25F);
    EXPECT_EQ(corrected.high, 0.75F);
    for (int i = 0; i <= 1000; ++i) {
      const double place = i / 1000.0;
      const double whole = at(spike(), place)[3];
      EXPECT_NEAR(at(corrected, place)[3], 1 - std::pow(1 - whole, step), 1e-5) << step << " at " << place;
    }
  }
}

TEST(OpacityCorrection, ColourGoesWithOpacityAndGlowWithLength) {
  const TransferFunction corrected = opacity_corrected(spike(), 0.5, 4);
  ASSERT_EQ(corrected.entries.size(), 4U);
  EXPECT_NEAR(corrected.entries[1][0] / corrected.entries[1][3], 0.5, 1e-6);
  EXPECT_NEAR(corrected.entries[3][2], 0.15, 1e-6) << "no opacity: half as long shines half as bright";
}

TEST(OpacityCorrection, OneStepChangesNothingAndOpaqueStaysOpaque) {
  EXPECT_EQ(opacity_corrected(spike(), 1, 4096), spike());
  const TransferFunction opaque{0, 1, {{1, 1, 1, 1}, {1, 1, 1, 1}}};
  for (const Rgba& entry : opacity_corrected(opaque, 1e-3, 16).entries) EXPECT_EQ(entry, (Rgba{1, 1, 1, 1}));
}

}  // namespace
}  // namespace understudy::volume::testing
