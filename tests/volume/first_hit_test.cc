// SPDX-License-Identifier: Apache-2.0
// The operator first-hit shows the first sample of each ray that is not clear, and nothing else.
#include <gtest/gtest.h>

#include "tests/volume/parts.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// Clear below the middle, then visible at once, so that rounding of values affects few samples.
TransferFunction step_table(float opacity) {
  TransferFunction table;
  for (int i = 0; i < 256; ++i) {
    const float a = i < 128 ? 0 : opacity;
    table.entries.push_back({0.3F * a, a * float(i) / 255, 0.6F * a, a});
  }
  return table;
}

RenderRequest request_of(const Texture& texture, bool on_steps) {
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, on_steps ? 0 : 50);
  request.op = Operator::first_hit;
  if (on_steps) {
    request.steps.emplace();
    request.steps->metric = {38, 3, 0, 0, 34, 0, 6, 0, 41};
  }
  if (texture.description.type != TexelType::rgba8) request.classification = step_table(0.2F);
  return request;
}

TEST(FirstHit, ShowsTheFirstSampleThatIsNotClear) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8})
    for (const bool on_steps : {false, true}) {
      const Texture texture = sampled(describe({29, 33, 31}, type, Wrap::edge), sphere_field(0.3, 0.2));
      RenderRequest request = request_of(texture, on_steps);
      if (type == TexelType::rgba8) {
        LinearMap map;
        map.alpha_above = 0.16F;  // hides the outside
        request.classification = map;
      }
      const Image image = render_whole(texture, request).image;
      const ReferenceImage exact = slice_sum(texture_field(texture.description, Filter::linear, texture.texels),
                                             request, request.window);
      const Difference d = difference(image, exact, 1e-3);
      std::printf("texels %d, steps %d: %d pixels hit another sample\n", int(type), on_steps, d.pixels_over);
      // If a sample's value equals the position of the table's step up to rounding, the next sample may be the
      // first.
      EXPECT_LE(d.pixels_over, 3);
      int hits = 0;
      for (std::size_t p = 3; p < image.rgba.size(); p += 4) {
        EXPECT_TRUE(image.rgba[p] == 0 || image.rgba[p] == 1) << image.rgba[p];
        hits += image.rgba[p] == 1;
      }
      EXPECT_GT(hits, 100);
      request.op = Operator::over;
      EXPECT_GT(difference(image, render_whole(texture, request).image).rms, 1e-2);
    }
}

TEST(FirstHit, IsTheSameForAnyPartition) {
  for (const int ranks : {2, 4, 7})
    for (const TexelType type : {TexelType::u8, TexelType::f32}) {
      const Texture texture = noise(describe({29, 33, 31}, type), unsigned(ranks));
      const RenderRequest request = request_of(texture, ranks == 4);
      const Whole one = render_whole(texture, request), many = render_parts(texture, request, ranks);
      EXPECT_LE(difference(one.image, many.image).max, 1e-5) << ranks << " ranks";
    }
}

TEST(FirstHit, IsTheTablesColourHoweverThinItIs) {
  const Texture texture = sampled(describe({9, 9, 9}, TexelType::f32), constant_field(1));
  for (const float opacity : {1e-40F, 1e-30F, 1e-9F, 0.5F, 1.0F}) {
    RenderRequest request = request_of(texture, true);
    request.classification = TransferFunction{0, 1, {{}, {0.25F * opacity, 0.5F * opacity, 0, opacity}}};
    const Image image = render_whole(texture, request).image;
    const float* const middle = image.at(request.window.x + 20, request.window.y + 18);
    EXPECT_NEAR(middle[0], 0.25F, 1e-4F) << opacity;
    EXPECT_NEAR(middle[1], 0.5F, 1e-4F) << opacity;
    EXPECT_EQ(middle[2], 0) << opacity;
    EXPECT_EQ(middle[3], 1) << opacity;
  }
}

TEST(FirstHit, PassesGlowAndStaysFinite) {
  const Texture texture = sampled(describe({9, 9, 9}, TexelType::f32), constant_field(1));
  RenderRequest request = request_of(texture, true);
  request.classification = TransferFunction{0, 1, {{1, 1, 1, 0}, {1, 1, 1, 0}}};
  for (const float v : render_whole(texture, request).image.rgba) EXPECT_EQ(v, 0);
  request.classification = TransferFunction{0, 1, {{1, 1, 1, 0}, {1, 1, 1, 1e-39F}}};
  for (const float v : render_whole(texture, request).image.rgba) EXPECT_TRUE(std::isfinite(v));
}

TEST(FirstHit, LeavesOutWhatLiesBehind) {
  const Texture texture = sampled(describe({64, 64, 64}, TexelType::u8), sphere_field(0.3, 0.2));
  RenderRequest request = request_of(texture, true);
  request.steps->metric = {128, 0, 0, 0, 128, 0, 0, 0, 128};
  const FrameCounts counts = render_whole(texture, request).counts;
  EXPECT_GT(counts.rays_terminated, 100U);
  EXPECT_LT(counts.samples_taken, counts.samples / 2);
}

}  // namespace
}  // namespace understudy::volume::testing
