// SPDX-License-Identifier: Apache-2.0
// The integral of a pixel from the bricks of one or several ranks equals that of the whole texture.
#include "volume/reference/stored_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

constexpr double tolerance = 1e-10;

struct StoredCase {
  const char* name;
  TexelType type;
  Wrap wrap;
  std::array<int, 3> size;
};

class StoredField : public ::testing::TestWithParam<StoredCase> {};

TEST_P(StoredField, ShowsTheIntegralsOfTheTexture) {
  const StoredCase& of = GetParam();
  const Texture texture = sampled(describe(of.size, of.type, of.wrap), marschner_lobb_field());
  const RenderRequest request = request_on_steps(texture);
  const Medium medium = Medium::of_samples(std::get<TransferFunction>(request.classification), 1);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  for (const int ranks : {1, 2, 5}) {
    const KdTree tree(texture.description, ranks);
    std::vector<BrickStore> stores;
    stores.reserve(std::size_t(ranks));
    for (int rank = 0; rank < ranks; ++rank) stores.push_back(filled(texture, tree.box(rank)));
    double opaque = 0;
    for (int y = 0; y < request.window.height; y += 5)
      for (int x = 0; x < request.window.width; x += 5) {
        const auto exact = pixel_integral(field, texture.description.size, request, medium, x, y);
        std::array<double, 3> colour{};
        double depth = 0;
        for (const int rank : tree.visibility_order(request)) {
          const RayIntegral part =
              stored_pixel_integral(stores[std::size_t(rank)], request, medium, x, y, tolerance);
          for (std::size_t k = 0; k < 3; ++k) colour[k] += std::exp(-depth) * part.colour[k];
          depth += part.optical_depth;
        }
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(colour[k], exact[k], 1e-8) << x << ", " << y;
        EXPECT_NEAR(-std::expm1(-depth), exact[3], 1e-8) << x << ", " << y;
        opaque = std::max(opaque, exact[3]);
      }
    EXPECT_GT(opaque, 0.3) << "there is something to see";
  }
}

INSTANTIATE_TEST_SUITE_P(Textures, StoredField,
                         ::testing::Values(StoredCase{"bytes", TexelType::u8, Wrap::edge, {40, 33, 17}},
                                           StoredCase{"words", TexelType::u16, Wrap::border, {17, 9, 40}},
                                           StoredCase{"floats", TexelType::f32, Wrap::edge, {8, 41, 30}},
                                           StoredCase{"a_plate", TexelType::f32, Wrap::border, {30, 1, 30}}),
                         [](const auto& info) { return info.param.name; });

/// The integral of the field along a path, by Simpson's rule, which is exact for cubics.
double integral_of(const std::vector<Stretch>& path) {
  double sum = 0;
  for (const Stretch& stretch : path) {
    const Cubic& value = stretch.value[0];
    sum += stretch.length * (value(0) + 4 * value(0.5) + value(1)) / 6;
  }
  return sum;
}

TEST(CellFaces, CutNoRayFarFromTheTexture) {
  const Texture texture = sampled(describe({40, 33, 17}, TexelType::u8), marschner_lobb_field());
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const BrickStore store = filled(texture);
  constexpr std::size_t faces = 42 + 35 + 19;
  // 64-bit integers cannot count the faces of the third path, and doubles cannot tell those of the last.
  for (const double far : {1e4, 1e8, 1e20, 1e307}) {
    const Vec3 from{-far, 0.3, 0.4}, to{far, 0.6, 0.5};
    const std::vector<Stretch> stored = stored_field_along_ray(store, from, to, 1);
    ASSERT_LE(stored.size(), faces + 1) << far;
    double length = 0;
    for (const Stretch& stretch : stored) length += stretch.length;
    EXPECT_NEAR(length, 1, 1e-12) << far;
    if (far > 1e4) continue;  // the reference counts texels in 32 bits
    const std::vector<Stretch> whole = field_along_ray(field, texture.description.size, from, to, 1);
    EXPECT_LE(whole.size(), faces + 1);
    EXPECT_NEAR(integral_of(whole), integral_of(stored), 1e-9);
  }
}

/// Steps of a thirtieth of the volume's depth (divided by `shorter`), at any angle of the ray.
RenderRequest between_planes(const Texture& texture, double shorter) {
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {0, 0, 30 * shorter, 0, 0, 0, 0, 0, 0};
  request.steps->first = 0.5;
  TransferFunction& table = std::get<TransferFunction>(request.classification);
  table = smooth_table(257, 0.1F);
  for (Rgba& entry : table.entries) {
    const double seen = -std::expm1(std::log1p(-double(entry[3])) / shorter);
    for (std::size_t k = 0; k < 3; ++k) entry[k] *= float(entry[3] > 0 ? seen / double(entry[3]) : 1 / shorter);
    entry[3] = float(seen);
  }
  return request;
}

TEST(StepsBetweenPlanes, TendToTheIntegralOverTheWayFromSliceToSlice) {
  Texture texture = sampled(describe({30, 30, 30}, TexelType::f32), sphere_field(0.3, 0.2));
  const RenderRequest whole = between_planes(texture, 1);
  const auto ray = pixel_ray(whole, 20, 17);
  ASSERT_TRUE(ray);
  EXPECT_NEAR(ray->length, 30 * std::abs(ray->to[2] - ray->from[2]), 1e-12);

  const Medium medium = Medium::of_samples(std::get<TransferFunction>(whole.classification), 1);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  for (const Method method : {Method::post_classified, Method::pre_integrated}) {
    RenderRequest request = between_planes(texture, 8);
    request.method = method;
    give_ghost_layer(texture, request);
    for (const int ranks : {1, 4}) {
      FrameCounts counts;
      const Image shown = drawn_in_parts(texture, request, ranks, counts);
      double worst = 0, most = 0;
      const Rect& seen = request.window;
      for (int y = seen.y; y < seen.y + seen.height; y += 3)
        for (int x = seen.x; x < seen.x + seen.width; x += 3) {
          const auto exact = pixel_integral(field, texture.description.size, whole, medium, x, y);
          for (std::size_t k = 0; k < 4; ++k)
            worst = std::max(worst, std::abs(exact[k] - double(shown.at(x, y)[k])));
          most = std::max(most, exact[3]);
        }
      EXPECT_LT(worst, 2e-3) << int(method) << " on " << ranks;
      EXPECT_GT(most, 0.3);
    }
  }
}

TEST(StepsBetweenPlanes, AreRefusedWhereSegmentsWouldBeEndless) {
  Texture texture = sampled(describe({30, 30, 30}, TexelType::f32), marschner_lobb_field());
  RenderRequest request = request_on_steps(texture);
  request.method = Method::pre_integrated;
  request.steps->metric = {0, 0, 30, 0, 0, 0, 0, 0, 0};
  const int facing = ghost_layer_needed(texture.description, request);
  EXPECT_GE(facing, 1);
  texture.description.ghost_layer = 1000;
  for (const int axis : {0, 1, 2}) {
    request.steps->metric = {};
    request.steps->metric[std::size_t(axis)] = 30;
    const int needed = ghost_layer_needed(texture.description, request);
    if (needed <= 1000) continue;
    FrameCounts counts;
    EXPECT_THROW(drawn(texture, request, counts), std::invalid_argument) << axis;
  }
}

}  // namespace
}  // namespace understudy::volume::testing
