// SPDX-License-Identifier: Apache-2.0
// A window's edge that the program cuts off is told from a silhouette, and from an image that is wrong
// elsewhere.
#include "spu/volume/verification/kept_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "volume/image.h"

namespace understudy::spu {
namespace {

constexpr int edge = 96;

/// A disc that reaches beyond the window.
volume::Image disc(double radius, const volume::Rect& kept = {0, 0, edge, edge}) {
  volume::Image image({0, 0, edge, edge});
  for (int y = kept.y; y < kept.y + kept.height; ++y) {
    for (int x = kept.x; x < kept.x + kept.width; ++x) {
      const double r = std::hypot(x - 48, y - 48);
      if (r >= radius) continue;
      const std::array<float, 4> colour{0.4F, float(0.3 + 0.3 * std::sin(0.2 * r)), 0.2F, 0.8F};
      std::copy(colour.begin(), colour.end(), image.at(x, y));
    }
  }
  return image;
}

std::optional<volume::Rect> kept(const volume::Image& theirs, const volume::Image& ours) {
  return kept_rect(Pipeline{}, NativeImage{theirs.rect, theirs.rgba}, ours.view());
}

TEST(KeptWindow, IsWhatTheProgramDoesNotDiscard) {
  for (const volume::Rect rect : {volume::Rect{0, 1, edge, edge - 1}, volume::Rect{0, 0, edge - 3, edge},
                                  volume::Rect{20, 30, 50, 40}, volume::Rect{0, 0, edge, edge - 1}})
    EXPECT_EQ(kept(disc(70, rect), disc(70)), rect);
}

TEST(KeptWindow, IsNoneWhereImagesAreAlike) {
  EXPECT_EQ(kept(disc(70), disc(70)), std::nullopt);
}

TEST(KeptWindow, IsNoneWhereASilhouetteIsSmaller) {
  EXPECT_EQ(kept(disc(30), disc(36)), std::nullopt);
}

TEST(KeptWindow, IsNoneWhereTheRestIsWrongToo) {
  volume::Image wrong = disc(70);
  for (float& value : wrong.rgba) value *= 0.7F;
  EXPECT_EQ(kept(disc(70, {0, 1, edge, edge - 1}), wrong), std::nullopt);
}

TEST(KeptWindow, IsNoneWhereOneOfThemShowsNothing) {
  EXPECT_EQ(kept(volume::Image({0, 0, edge, edge}), disc(70)), std::nullopt);
  EXPECT_EQ(kept(disc(70), volume::Image({0, 0, edge, edge})), std::nullopt);
}

}  // namespace
}  // namespace understudy::spu
