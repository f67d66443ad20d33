// SPDX-License-Identifier: Apache-2.0
// The colours of a light, derived from how three values of different colours look at many angles.
#include "spu/volume/proxy/light_colours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace understudy::spu {
namespace {

const std::vector<Tint> told_apart{{0.25, 0.05, 0.12}, {0.05, 0.22, 0.2}, {0.15, 0.12, 0.03}};
const std::vector<Tint> greys{{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}};

struct Illumination {
  Tint ambient{1, 1, 1};  ///< factor of the base colours
  Tint diffuse{4, 4, 4};
  Tint highlight{0.3, 0.3, 0.3};

  std::vector<Tint> shown(const std::vector<Tint>& base, double cosine) const {
    std::vector<Tint> lit = base;
    for (Tint& tint : lit) {
      for (std::size_t c = 0; c < 3; ++c)
        tint[c] = (ambient[c] + diffuse[c] * cosine) * tint[c] + highlight[c] * std::pow(cosine, 20);
    }
    return lit;
  }
};

std::vector<std::vector<Tint>> seen_of(const Illumination& illumination, const std::vector<Tint>& base) {
  std::vector<std::vector<Tint>> seen;
  for (int i = 0; i <= 32; ++i) seen.push_back(illumination.shown(base, i / 32.0));
  return seen;
}

volume::Light white() {
  volume::Light light;
  light.ambient = {0, 0, 0};
  light.diffuse = light.specular = {1, 1, 1};
  return light;
}

/// Worst channel error of a light with these colours whose response is fitted at each angle.
double worst_of(const volume::Light& light, const Illumination& illumination, const std::vector<Tint>& base) {
  double worst = 0;
  for (const auto& lit : seen_of(illumination, base))
    worst = std::max(worst, response_fit(light, base, lit).worst);
  return worst;
}

TEST(LightColours, AreWhiteWhereTheSourceIs) {
  for (const auto& base : {told_apart, greys})
    EXPECT_EQ(with_colours(white(), base, seen_of({}, base)), white()) << base.size();
}

TEST(LightColours, ExplainAWarmHighlight) {
  const Illumination illumination{.highlight = {0.35, 0.3, 0.18}};
  const volume::Light light = with_colours(white(), told_apart, seen_of(illumination, told_apart));
  EXPECT_GT(worst_of(white(), illumination, told_apart), 0.05) << "white must not explain it";
  EXPECT_LT(worst_of(light, illumination, told_apart), 1e-6);
  EXPECT_NEAR(light.specular[0] / light.specular[2], 0.35 / 0.18, 1e-5);
}

TEST(LightColours, ExplainAColouredLightBesideWhiteAmbientLight) {
  const Illumination illumination{.diffuse = {4, 3.7, 3.2}, .highlight = {0.3, 0.28, 0.24}};
  const volume::Light light = with_colours(white(), told_apart, seen_of(illumination, told_apart));
  EXPECT_GT(worst_of(white(), illumination, told_apart), 0.02) << "white must not explain it";
  EXPECT_LT(worst_of(light, illumination, told_apart), 1e-6);
  for (const float share : light.ambient) EXPECT_GE(share, 0) << "requests with less are refused";
}

TEST(LightColours, StayWhiteWhereOneGreyTellsNothing) {
  const std::vector<Tint> one_grey{{0.2, 0.2, 0.2}, {0.2, 0.2, 0.2}};
  EXPECT_EQ(with_colours(white(), one_grey, seen_of({}, one_grey)), white());
  EXPECT_LT(worst_of(white(), {}, one_grey), 1e-6);
}

TEST(LightColours, OfNoNumberAreNoFit) {
  std::vector<Tint> lit = Illumination{}.shown(told_apart, 0.5);
  lit[1][2] = std::nan("");
  EXPECT_TRUE(std::isinf(response_fit(white(), told_apart, lit).worst));
}

}  // namespace
}  // namespace understudy::spu
