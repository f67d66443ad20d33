// SPDX-License-Identifier: Apache-2.0
// The reference must itself agree with closed forms before other results are compared with it.
#include <gtest/gtest.h>

#include "tests/volume/scenes.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// A parallel view along +z with plane i at texture depth (i + 1/2) / planes.
RenderRequest straight_view(int planes) {
  RenderRequest r;
  r.texture_to_clip = {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1};
  r.viewport = r.window = {0, 0, 8, 6};
  r.planes = {{0, 0, 1}, 0.5 / planes, 1.0 / planes, planes};
  return r;
}

Field field(const ScalarField& scalar) {
  return [scalar](const Vec3& t) { return std::array<double, 4>{scalar(t), 0, 0, 0}; };
}

TEST(SliceSum, OfAConstantIsAPower) {
  for (const int n : {1, 10, 1000}) {
    RenderRequest r = straight_view(n);
    TransferFunction f;
    f.entries.assign(2, {0.05F, 0.1F, 0, 0.1F});
    r.classification = f;
    const ReferenceImage image = slice_sum(field(constant_field(0.3)), r, r.window);
    const double alpha = -std::expm1(n * std::log1p(-double(0.1F)));
    EXPECT_NEAR(image.at(3, 2)[3], alpha, 1e-13);
    EXPECT_NEAR(image.at(7, 0)[0], alpha * double(0.05F) / double(0.1F), 1e-13);
  }
}

TEST(SliceSum, OfALinearFieldUnderAddIsASeries) {
  RenderRequest r = straight_view(64);
  r.op = Operator::add;
  TransferFunction f;
  f.entries = {{0, 0, 0, 0}, {1, 1, 1, 1}};
  r.classification = f;
  const ReferenceImage image = slice_sum(field(linear_field({0, 0, 1}, 0)), r, r.window);
  EXPECT_NEAR(image.at(3, 2)[3], 32, 1e-12);
}

TEST(SliceSum, TakesExtremesPerComponent) {
  RenderRequest r = straight_view(4);
  TransferFunction f;
  f.entries = {{0, 1, 0, 0}, {1, 0, 1, 1}};
  r.classification = f;
  r.op = Operator::max;
  const Field ramp = field(linear_field({0, 0, 1}, 0));
  EXPECT_NEAR(slice_sum(ramp, r, r.window).at(0, 0)[0], 0.875, 1e-13);
  EXPECT_NEAR(slice_sum(ramp, r, r.window).at(0, 0)[1], 0.875, 1e-13);
  r.op = Operator::min;
  EXPECT_NEAR(slice_sum(ramp, r, r.window).at(0, 0)[0], 0.125, 1e-13);
}

TEST(SliceSum, SeesASphereInPerspectiveAsAnalysisDoes) {
  // Under `add`, a pixel counts the planes inside a ball, whose chord along a ray is known.
  RenderRequest r;
  r.viewport = r.window = {0, 0, 9, 9};
  const Vec3 eye{0, 0, 2};
  r.texture_to_clip =
      multiply(perspective(30, 1, 0.1, 10), multiply(look_at(eye, {0, 0, 0}, {0, 1, 0}), unit_cube()));
  const int n = 20000;
  r.planes = {{0, 0, -1}, -1 + 0.5 / n, 1.0 / n, n};
  r.op = Operator::add;
  TransferFunction f;
  f.entries = {{0, 0, 0, 0}, {0, 0, 0, 1}};
  r.classification = f;
  const double radius = 0.3;
  const Field ball =
      field([&](const Vec3& t) { return std::hypot(t[0] - 0.5, t[1] - 0.5, t[2] - 0.5) < radius ? 1.0 : 0.0; });
  const ReferenceImage image = slice_sum(ball, r, r.window);
  for (int x = 0; x < 9; ++x) {
    // Direction with unit z; the planes count the z-extent of the chord.
    const double dx = ((x + 0.5) / 4.5 - 1) * std::tan(15 * std::numbers::pi / 180);
    const double a = 1 + dx * dx, root = 4 - a * (4 - radius * radius);
    const double chord = root > 0 ? 2 * std::sqrt(root) / a : 0;
    EXPECT_NEAR(image.at(x, 4)[3] / n, chord, 1.1 / n) << x;
  }
}

TEST(TextureField, InterpolatesBetweenTexelCentresAndWraps) {
  VolumeDescription d = describe({2, 1, 1}, TexelType::u8);
  const std::vector<std::byte> texels{std::byte(0), std::byte(255)};
  const auto at = [&](Wrap wrap, double x, Filter filter = Filter::linear) {
    d.wrap = {wrap, Wrap::edge, Wrap::edge};
    d.border = {0.5F, 0, 0, 0};
    return texture_field(d, filter, texels)({x, 0.5, 0.5})[0];
  };
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0.25), 0);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0.4), 0.3);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0), 0);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 1), 1);
  EXPECT_DOUBLE_EQ(at(Wrap::border, 0), 0.25);
  EXPECT_DOUBLE_EQ(at(Wrap::border, 1), 0.75);
  EXPECT_DOUBLE_EQ(at(Wrap::repeat, 0), 0.5);
  EXPECT_DOUBLE_EQ(at(Wrap::repeat, 0.05), 0.4);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0.49, Filter::nearest), 0);
  EXPECT_DOUBLE_EQ(at(Wrap::edge, 0.51, Filter::nearest), 1);
}

}  // namespace
}  // namespace understudy::volume::testing
