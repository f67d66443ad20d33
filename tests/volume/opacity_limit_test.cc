// SPDX-License-Identifier: Apache-2.0
// Rays that end behind the sample at which their opacity reaches a limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

constexpr int width = 61;
constexpr int height = 47;

RenderRequest limited_request(const Texture& texture, float limit) {
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 60);
  if (texture.description.type != TexelType::rgba8) request.classification = smooth_table(256, 0.4F);
  request.opacity_limit = limit;
  return request;
}

Image image_of(const Texture& texture, const RenderRequest& request, FrameCounts* counts = nullptr) {
  const BrickStore store = filled(texture);
  Image image(request.window);
  FrameCounts mine;
  raycast(store, request, image, mine);
  if (counts != nullptr) *counts = mine;
  return image;
}

TEST(OpacityLimit, EndsRaysWhereTheReferenceEndsThem) {
  // Rounding may move the end of a ray close to the limit by one sample.
  constexpr double bound = 1e-4;
  constexpr int moved = width * height / 200;
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8})
    for (const float limit : {0.5F, 0.95F}) {
      const Texture texture = noise(describe({19, 23, 13}, type), 21);
      const RenderRequest request = limited_request(texture, limit);
      const Image image = image_of(texture, request);
      const Field field = texture_field(texture.description, request.filter, texture.texels);
      const Difference d = difference(image, slice_sum(field, request, request.window), bound);
      RenderRequest whole = request;
      whole.opacity_limit = 1;
      const double without = difference(image, image_of(texture, whole)).max;
      std::printf("limit %g: %d pixels differ by more than %g; whole rays by up to %.2f\n", double(limit),
                  d.pixels_over, bound, without);
      EXPECT_LE(d.pixels_over, moved);
      EXPECT_GT(without, 0.02);
    }
}

TEST(OpacityLimit, EndsLitRaysLikeOthers) {
  Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 22);
  texture.description.ghost_layer = 1;
  RenderRequest request = limited_request(texture, 0.8F);
  request.steps.emplace();
  request.steps->metric = {40, 0, 0, 0, 36, 0, 0, 0, 28};
  const Image unlit = image_of(texture, request);
  Light light;  // without any effect
  light.ambient = {1, 1, 1};
  light.diffuse = light.specular = {0, 0, 0};
  request.light = light;
  EXPECT_LE(difference(image_of(texture, request), unlit).max, 1e-5);
}

TEST(OpacityLimit, HoldsForUnlitBlocksOfSegments) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
    Texture texture = noise(describe({40, 40, 40}, type), 25);
    texture.description.ghost_layer = 1;
    RenderRequest request = limited_request(texture, 0.6F);
    request.steps.emplace();
    request.steps->metric = {60, 0, 0, 0, 60, 0, 0, 0, 60};
    const Image alone = image_of(texture, request);
    request.light.emplace().on_samples = false;  // of surfaces, of which there are none
    EXPECT_LE(difference(image_of(texture, request), alone).max, 1e-5);
  }
}

TEST(OpacityLimit, LeavesOutWhatLiesBehind) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 23);
  RenderRequest request = limited_request(texture, 1);
  FrameCounts whole, limited;
  image_of(texture, request, &whole);
  request.opacity_limit = 0.5F;
  image_of(texture, request, &limited);
  EXPECT_LT(limited.samples_taken, whole.samples_taken);
  EXPECT_GT(limited.rays_terminated, whole.rays_terminated);
}

TEST(OpacityLimit, IsRefusedWhereItMeansNothing) {
  const Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 24);
  for (const float limit : {0.0F, -1.0F, 1.5F})
    EXPECT_THROW(image_of(texture, limited_request(texture, limit)), std::invalid_argument) << limit;
  RenderRequest request = limited_request(texture, 0.5F);
  request.op = Operator::add;
  EXPECT_THROW(image_of(texture, request), std::invalid_argument);
  request.op = Operator::over;
  request.steps.emplace().metric = {9, 0, 0, 0, 9, 0, 0, 0, 9};
  request.surfaces = {{0.5F, {1, 1, 1, 1}}};
  EXPECT_THROW(image_of(texture, request), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
