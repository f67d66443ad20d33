// SPDX-License-Identifier: Apache-2.0
// Pre-integrated segments: their table compared with quadrature, their images with the volume rendering
// integral.
#include "volume/raycast/pre_integration.h"

#include <gtest/gtest.h>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

TransferFunction spikes(float top) {
  TransferFunction f;
  for (int i = 0; i < 40; ++i) f.entries.push_back(i % 13 == 5 ? Rgba{top, 0.5F * top, 0, top} : Rgba{});
  return f;
}

std::array<double, 4> integrated(const Medium& medium, double front, double back, double length) {
  Stretch stretch;
  stretch.length = length;
  stretch.value[0].c = {front, back - front, 0, 0};
  const RayIntegral sum = ray_integral(std::span(&stretch, 1), medium);
  return {sum.colour[0], sum.colour[1], sum.colour[2], sum.opacity()};
}

TEST(PreIntegration, TableHoldsTheIntegralsOfAllSegments) {
  TransferFunction dense = spikes(0.9F);
  dense.entries[20] = {0.2F, 0.9F, 0.95F, 0.99F};
  for (const TransferFunction& function :
       {smooth_table(256, 0.9F), smooth_table(2, 0.3F), spikes(0.9F), dense}) {
    const PreIntegrationTable table = pre_integrated(function);
    const Medium medium = Medium::of_samples(function, 1);
    ASSERT_GE(table.edge, 256);
    ASSERT_EQ(table.entries.size(), std::size_t(table.edge) * std::size_t(table.edge));
    double worst = 0;
    for (int front = 0; front < table.edge; front += 37)
      for (int back = front % 41; back < table.edge; back += 41) {
        const double last = table.edge - 1;
        const auto exact = integrated(medium, front / last, back / last, 1);
        for (std::size_t k = 0; k < 4; ++k)
          worst = std::max(
              worst, std::abs(exact[k] - double(table.entries[std::size_t(back * table.edge + front)][k])));
      }
    std::printf("%zu entries, edge %d: at most %.2e off\n", function.entries.size(), table.edge, worst);
    EXPECT_LE(worst, 1e-4);
  }
}

TEST(PreIntegration, OfManyEntriesKeepsTheirNumberUpTo1024) {
  EXPECT_EQ(pre_integrated(smooth_table(300)).edge, 300);
  EXPECT_EQ(pre_integrated(smooth_table(1024)).edge, 1024);
  EXPECT_EQ(pre_integrated(smooth_table(5000)).edge, 1024);
}

TEST(PreIntegration, TableOfGlowAndNothingIsFinite) {
  TransferFunction glow{0, 1, {{0.5F, 0, 0, 0}, {0, 0, 0, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}, {2, 0, 0, 1e-9F}}};
  for (const Rgba& entry : pre_integrated(glow).entries)
    for (const float v : entry) EXPECT_TRUE(std::isfinite(v));
  const PreIntegrationTable table = pre_integrated(glow);
  EXPECT_NEAR(table.entries[0][0], 0.5F, 1e-6F);
  EXPECT_EQ(table.entries[0][3], 0);
}

RenderRequest request_of(const Texture& texture, bool cut, bool lit) {
  RenderRequest request = request_on_steps(texture);
  request.method = Method::pre_integrated;
  if (cut) {
    request.steps->first = 0.4;
    request.clip_planes = {{{1, 0.3, -0.2}, -0.35}};
    request.surfaces = {{0.6, {0.9F, 0.2F, 0.1F, 0.5F}}};
  }
  if (lit) request.light = some_light();
  return request;
}

TEST(PreIntegration, IsWhatDoublePrecisionSays) {
  for (const TexelType type : {TexelType::u8, TexelType::f32})
    for (const bool cut : {false, true})
      for (const bool lit : {false, true}) {
        Texture texture = sampled(describe({40, 37, 43}, type), sphere_field(0.3, 0.2));
        RenderRequest request = request_of(texture, cut, lit);
        request.window = {10, 12, 20, 15};  // quadrature is slow
        give_ghost_layer(texture, request);
        FrameCounts counts;
        const Image image = drawn(texture, request, counts);
        const Difference d = difference(image, expected(texture, request), 1e-3);
        std::printf("texels %d, cut %d, lit %d: max %.2e, rms %.2e\n", int(type), cut, lit, d.max, d.rms);
        EXPECT_LE(d.pixels_over, cut ? pixels_that_graze : 0);
        EXPECT_LE(d.rms, 1e-4);
      }
}

TEST(PreIntegration, IsNearerToTheIntegralThanSamplesAre) {
  Texture texture = sampled(describe({40, 37, 43}, TexelType::u16), sphere_field(0.3, 0.2));
  RenderRequest request = request_on_steps(texture);
  request.window = {10, 12, 20, 15};
  request.classification = spikes(0.5F);
  request.method = Method::pre_integrated;
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image segments = drawn(texture, request, counts);
  request.method = Method::post_classified;
  const Image samples = drawn(texture, request, counts);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const Medium medium = Medium::of_samples(std::get<TransferFunction>(request.classification), 1);
  ReferenceImage exact{request.window, {}};
  for (int y = request.window.y; y < request.window.y + request.window.height; ++y)
    for (int x = request.window.x; x < request.window.x + request.window.width; ++x)
      for (const double v : pixel_integral(field, texture.description.size, request, medium, x, y))
        exact.rgba.push_back(v);
  const double by_segments = difference(segments, exact).rms, by_samples = difference(samples, exact).rms;
  std::printf("rms error of segments %.2e, of samples %.2e\n", by_segments, by_samples);
  EXPECT_LT(by_segments, by_samples / 4);
}

TEST(PreIntegration, IsTheSameForAnyPartition) {
  double worst = 0;
  for (int ranks = 2; ranks <= 8; ++ranks)
    for (const bool lit : {false, true}) {
      Texture texture = noise(describe({40, 37, 43}, TexelType::u8), unsigned(ranks));
      const RenderRequest request = request_of(texture, ranks % 2 == 0, lit);
      give_ghost_layer(texture, request);
      FrameCounts one, many;
      const double d =
          difference(drawn(texture, request, one), drawn_in_parts(texture, request, ranks, many)).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, 1e-5) << ranks << " ranks";
      EXPECT_EQ(one.samples, many.samples) << ranks << " ranks";
    }
  std::printf("2 to 8 ranks against 1: largest difference %.2e\n", worst);
}

TEST(PreIntegration, CutAtBricksDependsOnTheBricks) {
  Texture texture = sampled(describe({64, 64, 64}, TexelType::u16), marschner_lobb_field());
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {64, 0, 0, 0, 64, 0, 0, 0, 64};
  request.classification = smooth_table(256, 0.1F);
  request.method = Method::pre_integrated;
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image uncut = drawn(texture, request, counts);
  double last = 0;
  for (const int ranks : {64, 512}) {
    const double seamless = difference(drawn_in_parts(texture, request, ranks, counts), uncut).max;
    RenderRequest cut = request;
    cut.cut_at_bricks = 8;  // the ranks' own bricks are smaller
    const Difference d = difference(drawn_in_parts(texture, cut, ranks, counts), uncut);
    std::printf("%d bricks: cut at their faces max %.2e, rms %.2e; uncut max %.2e\n", ranks, d.max, d.rms,
                seamless);
    EXPECT_LE(seamless, 1e-5);
    EXPECT_GT(d.max, std::max(1e-5, last)) << "cuts that change nothing";
    EXPECT_LE(d.max, 5e-3);
    last = d.max;
  }
}

TEST(PreIntegration, CutAtBricksOfOneRankIsCutAsByRanks) {
  // 64 ranks have the same 4 x 4 x 4 bricks of 16 cells at whose faces one rank is told to cut.
  Texture texture = sampled(describe({65, 65, 65}, TexelType::u16), marschner_lobb_field());
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {64, 0, 0, 0, 64, 0, 0, 0, 64};
  request.classification = smooth_table(256, 0.1F);
  request.method = Method::pre_integrated;
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image uncut = drawn(texture, request, counts);
  RenderRequest cut = request;
  cut.cut_at_bricks = 255;
  EXPECT_EQ(difference(drawn(texture, cut, counts), uncut).max, 0) << "one brick";
  const Image by_ranks = drawn_in_parts(texture, cut, 64, counts);
  cut.cut_at_bricks = 2;
  const Image by_bricks = drawn(texture, cut, counts);
  std::printf("cut at bricks of 16: %.2e from uncut, %.2e from ranks with such bricks\n",
              difference(by_bricks, uncut).max, difference(by_bricks, by_ranks).max);
  EXPECT_LE(difference(by_bricks, by_ranks).max, 1e-6);
  EXPECT_GT(difference(by_bricks, uncut).max, 1e-5);
  // More ranks add no cuts if their faces are among the bricks' faces.
  EXPECT_LE(difference(drawn_in_parts(texture, cut, 8, counts), by_bricks).max, 1e-6);
  VolumeDescription large = texture.description;
  large.size = {1024, 1024, 1024};
  large.stored = {{0, 0, 0}, large.size};
  large.ghost_layer = 16;
  cut.cut_at_bricks = 4;
  EXPECT_NO_THROW(validate(large, cut));
  cut.cut_at_bricks = 1;
  EXPECT_THROW(validate(large, cut), std::invalid_argument) << "two million bricks";
}

TEST(PreIntegration, LeavesOutWhatIsClear) {
  Texture texture = sampled(describe({96, 96, 96}, TexelType::u8), sphere_field(0.25, 0.01));
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {90, 0, 0, 0, 90, 0, 0, 0, 90};
  request.window = {10, 12, 20, 15};
  request.method = Method::pre_integrated;
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image image = drawn(texture, request, counts);
  EXPECT_GT(counts.blocks_empty, counts.blocks / 2);
  EXPECT_LT(counts.samples_taken, counts.samples / 2);
  EXPECT_LE(difference(image, expected(texture, request), 1e-3).pixels_over, 0);
}

}  // namespace
}  // namespace understudy::volume::testing
