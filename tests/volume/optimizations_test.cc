// SPDX-License-Identifier: Apache-2.0
// What the ray caster skips does not change any image, and its counts add up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string_view>

#include "tests/volume/random_scenes.h"
#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

struct ImageAndCounts {
  Image image;
  FrameCounts counts;
};

ImageAndCounts draw(const BrickStore& store, const RenderRequest& request) {
  ImageAndCounts drawn{Image(request.window), {}};
  raycast(store, request, drawn.image, drawn.counts);
  return drawn;
}

double brightest(const Image& image) {
  double most = 1;
  for (const float value : image.rgba)
    if (value < 1e30F) most = std::max(most, double(value));
  return most;
}

std::uint64_t left_in_empty_bricks(const FrameCounts& c) {
  return c.samples - c.samples_taken - c.samples_hidden - c.dominated_samples;
}

TEST(Optimizations, OfEmptyBricksChangesNoImage) {
  double worst = 0;
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8})
    for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add, Operator::first_hit})
      for (const Filter filter : {Filter::linear, Filter::nearest}) {
        // Half of the volume is empty space: values below the table's lowest visible value, or NaN for minima
        // of floats.
        const Texture texture = sampled(describe({70, 66, 50}, type), [&](const Vec3& t) {
          const double r = std::hypot(t[0] - 0.3, t[1] - 0.35, t[2] - 0.6);
          if (r < 0.2) return 1 - r;
          return op == Operator::min && type == TexelType::f32 ? std::nan("") : 0.0;
        });
        RenderRequest request = request_for(texture, usual_camera(61, 57), 61, 57, 150);
        request.op = op;
        request.filter = filter;
        const BrickStore store = filled(texture);
        const ImageAndCounts usual = draw(store, request);
        request.optimizations.empty_bricks = false;
        const ImageAndCounts all = draw(store, request);
        const double d = difference(usual.image, all.image).max;
        worst = std::max(worst, d);
        EXPECT_LE(d, 0) << "type " << int(type) << ", operator " << int(op);
        EXPECT_EQ(all.counts.blocks_empty, 0U);
        EXPECT_EQ(left_in_empty_bricks(all.counts), 0U);
        const bool has_empty_bricks = op != Operator::min || type == TexelType::f32;
        EXPECT_EQ(usual.counts.blocks_empty > usual.counts.blocks / 2, has_empty_bricks)
            << "type " << int(type) << ", operator " << int(op);
      }
  std::printf("images differ by %.1e\n", worst);
}

TEST(Optimizations, ChangesNoImageOfScenesThatNobodyThoughtOf) {
  const unsigned seed = test_seed();
  std::mt19937 random(seed);
  double worst = 0;
  for (int i = 0; i < 80; ++i) {
    RandomScene scene = random_scene(random);
    const BrickStore store = filled(scene.texture);
    scene.request.termination = 0;
    const ImageAndCounts usual = draw(store, scene.request);
    scene.request.optimizations = {false, false, false};
    const ImageAndCounts all = draw(store, scene.request);
    const double d = difference(usual.image, all.image).max / brightest(all.image);
    worst = std::max(worst, d);
    EXPECT_LE(d, 1e-6) << scene.text << ", UNDERSTUDY_TEST_SEED=" << seed;
    if (scene.request.method == Method::adaptive) continue;
    EXPECT_EQ(all.counts.samples, all.counts.samples_taken) << scene.text;
  }
  std::printf("seed %u: images differ by %.1e of the brightest\n", seed, worst);
}

TEST(Optimizations, OfHiddenSamplesIsCountedAndKeepsTheThreshold) {
  const Texture texture = sampled(describe({60, 52, 47}, TexelType::u8), sphere_field(0.4));
  RenderRequest request = request_for(texture, usual_camera(64, 64), 64, 64, 200);
  request.classification = smooth_table(256, 0.9F);
  const BrickStore store = filled(texture);
  const ImageAndCounts all = draw(store, request);
  EXPECT_EQ(all.counts.samples_hidden, 0U);
  request.termination = 5e-6F;
  const ImageAndCounts usual = draw(store, request);
  EXPECT_GT(usual.counts.samples_hidden, usual.counts.samples / 10);
  EXPECT_LT(usual.counts.samples_taken, all.counts.samples_taken);
  EXPECT_LE(usual.counts.samples_taken + usual.counts.samples_hidden, usual.counts.samples);
  EXPECT_LE(difference(usual.image, all.image).max, 5e-6);
}

TEST(Optimizations, OfDominatedSamplesNeedsColoursThatRise) {
  const Texture texture = sampled(describe({60, 52, 47}, TexelType::u8), sphere_field(0.4));
  RenderRequest request = request_for(texture, usual_camera(64, 64), 64, 64, 200);
  request.op = Operator::max;
  const BrickStore store = filled(texture);
  // Like a viewer's 8-bit transfer function: increasing, with runs of equal entries.
  TransferFunction rising;
  for (int i = 0; i < 256; ++i) {
    const float value = float(i * i / 255) / 255;
    rising.entries.push_back({value, value, value, float(i) / 255});
  }
  request.classification = rising;
  const ImageAndCounts usual = draw(store, request);
  request.optimizations.dominated_samples = false;
  const ImageAndCounts all = draw(store, request);
  const bool plain = std::string_view(instruction_set()) == "scalar";  // it skips empty bricks only
  EXPECT_GT(usual.counts.dominated_samples, plain ? 0 : left_in_empty_bricks(all.counts));
  EXPECT_EQ(all.counts.dominated_samples, 0U);
  EXPECT_LE(difference(usual.image, all.image).max, 1e-6);

  request.optimizations.dominated_samples = true;
  for (std::size_t i = 128; i < 256; ++i) rising.entries[i][1] = 0.5F - float(i) / 512;
  request.classification = rising;
  EXPECT_EQ(draw(store, request).counts.dominated_samples, 0U) << "green falls: the largest value is not all";
}

}  // namespace
}  // namespace understudy::volume::testing
