// SPDX-License-Identifier: Apache-2.0
#include "compositor/blend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "compositor/crop.h"
#include "volume/blending_operator.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {
namespace {

using volume::Image;
using volume::Operator;
using volume::Rect;

std::vector<float> random_pixels(std::size_t pixels, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> result;
  for (std::size_t i = 0; i < pixels; ++i) {
    const float alpha = uniform(random) < 0.1F ? 0.0F : uniform(random) < 0.1F ? 1.0F : uniform(random);
    for (int c = 0; c < 3; ++c) result.push_back(alpha * uniform(random));
    result.push_back(alpha);
  }
  return result;
}

double expected(Operator op, double front, double back, double front_alpha) {
  switch (op) {
    case Operator::over:
    case Operator::first_hit:
      return front + (1 - front_alpha) * back;
    case Operator::max:
      return std::max(front, back);
    case Operator::min:
      return std::min(front, back);
    case Operator::add:
      return front + back;
  }
  return 0;
}

TEST(Blend, FollowsTheDefinitionForEveryOperatorAndAnyNumberOfPixels) {
  const unsigned seed = 20;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  double worst = 0;
  for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add})
    for (std::size_t pixels = 0; pixels < 40; ++pixels) {
      const std::vector<float> front = random_pixels(pixels, random), back = random_pixels(pixels, random);
      std::vector<float> result = front;
      blend(op, result, back);
      for (std::size_t i = 0; i < result.size(); ++i)
        worst = std::max(worst, std::abs(result[i] - expected(op, front[i], back[i], front[i / 4 * 4 + 3])));
    }
  std::printf("largest error %.2g\n", worst);
  EXPECT_LE(worst, 2e-7);
}

TEST(Blend, APixelDoesNotDependOnWhereItsRunBegins) {
  std::mt19937 random(21);
  const std::vector<float> front = random_pixels(64, random), back = random_pixels(64, random);
  std::vector<float> whole = front;
  blend(Operator::over, whole, back);
  for (std::size_t first = 0; first < 64; ++first) {
    std::vector<float> part(front.begin() + std::ptrdiff_t(4 * first), front.end());
    blend(Operator::over, part, std::span(back).subspan(4 * first));
    EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin() + std::ptrdiff_t(4 * first))) << first;
  }
}

TEST(Blend, FogOfAThousandThinLayersAddsUp) {
  std::vector<float> sum(4, 0.0F);
  const std::vector<float> layer{1e-9F, 1e-9F, 1e-9F, 1e-9F};
  for (int i = 0; i < 1000; ++i) blend(Operator::over, sum, layer);
  std::printf("alpha %.9g instead of 1e-6\n", double(sum[3]));
  EXPECT_NEAR(sum[3], 1e-6, 1e-10);
}

/// Blends layers [first, last): divides them anywhere, and blends the two halves.
std::vector<float> blended_as_a_tree(Operator op, const std::vector<std::vector<float>>& layers,
                                     std::size_t first, std::size_t last, std::mt19937& random) {
  if (last - first == 1) return layers[first];
  const std::size_t middle = first + 1 + random() % (last - first - 1);
  std::vector<float> front = blended_as_a_tree(op, layers, first, middle, random);
  blend(op, front, blended_as_a_tree(op, layers, middle, last, random));
  return front;
}

TEST(Blend, AnyTreeOfUpTo1024ImagesGivesTheProductInDouble) {
  constexpr std::size_t pixels = 64;
  std::mt19937 random(17);
  for (const std::size_t count : {1, 2, 3, 7, 32, 129, 1024}) {
    double worst = 0;
    for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add})
      for (const float thinness : {1.0F, 0.01F, 1e-6F}) {
        std::vector<std::vector<float>> layers;
        layers.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
          layers.push_back(random_pixels(pixels, random));
          for (float& value : layers.back()) value *= thinness;
        }
        const std::vector<float> image = blended_as_a_tree(op, layers, 0, count, random);
        for (std::size_t p = 0; p < 4 * pixels; p += 4) {
          std::array<double, 4> product{};
          for (std::size_t c = 0; c < 4; ++c) product[c] = double(layers[0][p + c]);
          for (std::size_t i = 1; i < count; ++i) {
            const double alpha = product[3];
            for (std::size_t c = 0; c < 4; ++c)
              product[c] = expected(op, product[c], double(layers[i][p + c]), alpha);
          }
          for (std::size_t c = 0; c < 4; ++c) {
            // The error of a sum grows with the sum.
            const double unit = op == Operator::add ? std::max(1.0, product[c]) : 1;
            worst = std::max(worst, std::abs(double(image[p + c]) - product[c]) / unit);
          }
        }
      }
    std::printf("%4zu images: at most %.2g apart\n", count, worst);
    EXPECT_LE(worst, 2e-6);
  }
}

TEST(Blend, NothingShinesThroughAnAlphaThatRoundingLeftAboveOne) {
  std::vector<float> front{1, 1, 1, 1.0000001F};
  const std::vector<float> back{1000, 1000, 1000, 1};
  blend(Operator::over, front, back);
  EXPECT_EQ(front[0], 1.0F);
}

TEST(Blend, NeutralPixelsChangeNothingOnEitherSide) {
  std::mt19937 random(22);
  const std::vector<float> pixels = random_pixels(9, random);
  for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
    const std::vector<float> neutral(pixels.size(), volume::neutral_value(op));
    std::vector<float> result = neutral;
    blend(op, result, pixels);
    EXPECT_EQ(result, pixels);
    blend(op, result, neutral);
    EXPECT_EQ(result, pixels);
  }
}

TEST(Blend, AnImageTouchesOnlyWhatItCovers) {
  Image front(Rect{2, 3, 5, 4});
  Image back(Rect{4, 1, 9, 4});
  std::ranges::fill(back.rgba, 0.5F);
  blend(Operator::over, front, back.view());
  for (int y = 3; y < 7; ++y)
    for (int x = 2; x < 7; ++x) EXPECT_EQ(*front.at(x, y), x >= 4 && y < 5 ? 0.5F : 0.0F) << x << ' ' << y;
}

TEST(Crop, KeepsEveryTouchedPixelAndNoRimOfOthers) {
  std::mt19937 random(23);
  for (const Operator op : {Operator::over, Operator::min})
    for (int trial = 0; trial < 200; ++trial) {
      Image image(Rect{-3, 7, 1 + int(random() % 12), 1 + int(random() % 12)});
      std::ranges::fill(image.rgba, volume::neutral_value(op));
      Rect touched;
      for (unsigned i = random() % 4; i > 0; --i) {
        const int x = image.rect.x + int(random() % unsigned(image.rect.width));
        const int y = image.rect.y + int(random() % unsigned(image.rect.height));
        image.at(x, y)[random() % 4] = float(i);
        touched = bounding(touched, {x, y, 1, 1});
      }
      const Image before = image;
      crop_to_content(image, op);
      ASSERT_EQ(image.rect, touched);
      ASSERT_EQ(image.rgba.size(), 4 * touched.pixels());
      for (int y = touched.y; y < touched.y + touched.height; ++y)
        for (int x = touched.x; x < touched.x + touched.width; ++x)
          for (int c = 0; c < 4; ++c) ASSERT_EQ(image.at(x, y)[c], before.at(x, y)[c]);
    }
}

}  // namespace
}  // namespace understudy::compositor
