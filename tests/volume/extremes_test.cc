// SPDX-License-Identifier: Apache-2.0
// Hard cases: for any texels and view the image is finite, and correct wherever correctness is defined.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

Image rendered_extreme(const Texture& texture, const RenderRequest& request) {
  const BrickStore store = filled(texture);
  Image image(request.window);
  FrameCounts counts;
  raycast(store, request, image, counts);
  return image;
}

Difference against_reference(const Texture& texture, const RenderRequest& request) {
  const Field field = texture_field(texture.description, request.filter, texture.texels);
  return difference(rendered_extreme(texture, request), slice_sum(field, request, request.window));
}

void put(Texture& texture, std::size_t index, float value) {
  std::memcpy(texture.texels.data() + index * sizeof value, &value, sizeof value);
}

bool finite(const Image& image) {
  return std::all_of(image.rgba.begin(), image.rgba.end(), [](float v) { return std::isfinite(v); });
}

TEST(Extremes, SamplesThatTouchNanContributeNothing) {
  for (const Filter filter : {Filter::linear, Filter::nearest})
    for (const Operator op :
         {Operator::over, Operator::max, Operator::min, Operator::add, Operator::first_hit}) {
      Texture texture = noise(describe({19, 17, 21}, TexelType::f32), 41);
      std::mt19937 random(42);
      for (int i = 0; i < 400; ++i) put(texture, random() % stored_texels(texture.description), std::nanf(""));
      RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
      request.filter = filter;
      request.op = op;
      EXPECT_TRUE(finite(rendered_extreme(texture, request)));
      EXPECT_LE(against_reference(texture, request).max, 1e-4);
    }
}

TEST(Extremes, AFieldOfNanIsClear) {
  const Texture texture = sampled(describe({19, 17, 21}, TexelType::f32), constant_field(std::nan("")));
  const RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
  EXPECT_EQ(difference(rendered_extreme(texture, request), Image(request.window)).max, 0);
}

TEST(Extremes, InfiniteAndHugeTexelsStayFinite) {
  constexpr float infinity = std::numeric_limits<float>::infinity(), most = std::numeric_limits<float>::max();
  constexpr float denormal = std::numeric_limits<float>::denorm_min();
  const float values[] = {infinity, -infinity, most, -most, 1e30F, -1e30F, denormal, 0.0F, 0.5F};
  Texture texture = noise(describe({19, 17, 21}, TexelType::f32), 43);
  std::mt19937 random(44);
  for (std::size_t i = 0; i < stored_texels(texture.description); ++i)
    put(texture, i, values[random() % std::size(values)]);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
  for (const auto& [low, high] : {std::pair{0.0F, 1.0F}, {-most, most}, {0.0F, denormal}, {-1e30F, 1e30F}}) {
    TransferFunction table = smooth_table();
    table.low = low;
    table.high = high;
    request.classification = table;
    for (const Operator op :
         {Operator::over, Operator::max, Operator::min, Operator::add, Operator::first_hit}) {
      request.op = op;
      const Image image = rendered_extreme(texture, request);
      EXPECT_TRUE(finite(image));
    }
  }
}

TEST(Extremes, AlphaOneIsExactlyOpaque) {
  const Texture texture = sampled(describe({9, 9, 9}, TexelType::u8), constant_field(0.4));
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
  TransferFunction opaque;
  opaque.entries.assign(2, {0.25F, 0.5F, 1.0F, 1.0F});
  request.classification = opaque;
  const Image image = rendered_extreme(texture, request);
  int covered = 0;
  for (std::size_t p = 0; p < image.rgba.size(); p += 4)
    if (image.rgba[p + 3] != 0) {
      ++covered;
      EXPECT_EQ(image.rgba[p + 3], 1.0F);
      EXPECT_EQ(image.rgba[p], 0.25F);
      EXPECT_EQ(image.rgba[p + 1], 0.5F);
      EXPECT_EQ(image.rgba[p + 2], 1.0F);
    }
  EXPECT_GT(covered, 100);
}

TEST(Extremes, OpacityNeverExceedsOneNorColourOpacity) {
  const Texture texture = noise(describe({33, 33, 33}, TexelType::u8), 45);
  RenderRequest request = request_for(texture, usual_camera(61, 57), 61, 57, 300);
  TransferFunction comb;  // alternately clear and opaque
  for (int i = 0; i < 256; ++i) comb.entries.push_back(i % 2 ? Rgba{1, 0.5F, 0.25F, 1} : Rgba{});
  request.classification = comb;
  const Image image = rendered_extreme(texture, request);
  for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
    ASSERT_LE(image.rgba[p + 3], 1.0F);
    ASSERT_GE(image.rgba[p + 3], 0.0F);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_LE(image.rgba[p + k], image.rgba[p + 3] + 1e-6F);
  }
}

TEST(Extremes, GlowAddsColourWithoutOpacity) {
  const Texture texture = noise(describe({19, 17, 21}, TexelType::u8), 46);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
  TransferFunction glow;
  for (int i = 0; i < 64; ++i) glow.entries.push_back({float(i) / 64, 0.1F, 0, 0});
  request.classification = glow;
  EXPECT_LE(against_reference(texture, request).max, 1e-4);
  EXPECT_GT(rendered_extreme(texture, request).at(23, 24)[0], 1.0F);
}

TEST(Extremes, ViewportsOfOnePixelAndOfOneLongRow) {
  const Texture texture = noise(describe({19, 17, 21}, TexelType::u8), 47);
  EXPECT_LE(against_reference(texture, request_for(texture, usual_camera(1, 1), 1, 1, 40)).max, 5e-5);
  EXPECT_LE(against_reference(texture, request_for(texture, usual_camera(1, 1), 16384, 1, 40)).max, 5e-5);
  EXPECT_LE(against_reference(texture, request_for(texture, usual_camera(1, 1), 1, 4096, 40)).max, 5e-5);
}

TEST(Extremes, AWorldFarFromTheOriginIsAsGood) {
  // Eye and unit volume lie at 1e7; the product of the matrices in double loses the digits.
  const Texture texture = noise(describe({19, 17, 21}, TexelType::u8), 48);
  const double far = 1e7;
  const Matrix4 model{1, 0, 0, far - 0.5, 0, 1, 0, far - 0.5, 0, 0, 1, far - 0.5, 0, 0, 0, 1};
  const Matrix4 m =
      multiply(perspective(40, 41.0 / 37, 0.1, 10),
               multiply(look_at({far + 0.9, far + 0.7, far + 1.6}, {far, far, far}, {0, 1, 0}), model));
  EXPECT_LE(against_reference(texture, request_for(texture, m, 41, 37, 40)).max, 5e-5);
}

TEST(Extremes, MirroringTheSceneMirrorsTheImage) {
  Texture texture = noise(describe({19, 17, 21}, TexelType::u8), 49);
  const RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 40);
  const Image image = rendered_extreme(texture, request);
  RenderRequest mirrored = request;
  for (int k = 0; k < 4; ++k)
    mirrored.texture_to_clip[std::size_t(k)] = -mirrored.texture_to_clip[std::size_t(k)];
  const Image reflection = rendered_extreme(texture, mirrored);
  double worst = 0;
  for (int y = 0; y < 37; ++y)
    for (int x = 0; x < 41; ++x)
      for (int k = 0; k < 4; ++k)
        worst = std::max(
            worst, std::abs(double(image.at(3 + x, 5 + y)[k]) - double(reflection.at(3 + 40 - x, 5 + y)[k])));
  std::printf("mirrored image differs by %.2e\n", worst);
  EXPECT_LE(worst, 1e-5);
}

TEST(Extremes, LongRaysKeepTheirPrecision) {
  // Many planes through few texels: positions are computed from the index, never as a running sum.
  const Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 50);
  RenderRequest request = request_for(texture, usual_camera(7, 7), 7, 7, 200000);
  request.classification = smooth_table(256, 1e-4F);
  const double d = against_reference(texture, request).max;
  std::printf("200,000 planes: %.2e\n", d);
  EXPECT_LE(d, 2e-4);
}

}  // namespace
}  // namespace understudy::volume::testing
