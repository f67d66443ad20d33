// SPDX-License-Identifier: Apache-2.0
// Transfer functions from control points, and the orbit camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"
#include "volume/transfer_control_points.h"

namespace understudy::volume::testing {
namespace {

using ::testing::HasSubstr;

std::string trouble_with(const TransferControlPoints& control_points) {
  try {
    check(control_points);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(TransferControlPoints, WhatMakesNoSenseIsRefusedWithTheControlPoint) {
  const TransferControlPoints::ControlPoint low{0, {0, 0, 0}, 0}, high{1, {1, 1, 1}, 0.5};
  EXPECT_EQ(trouble_with({false, {low, high}}), "");
  EXPECT_THAT(trouble_with({false, {}}), HasSubstr("0 control points are too few"));
  EXPECT_THAT(trouble_with({false, {low}}), HasSubstr("1 control points are too few"));
  EXPECT_THAT(trouble_with({false, {high, low}}), HasSubstr("control point 2: it stands at 0"));
  EXPECT_THAT(trouble_with({false, {low, {1, {}, -0.1}}}), HasSubstr("control point 2: its opacity is -0.1"));
  EXPECT_THAT(trouble_with({false, {low, {1, {}, std::nan("")}}}), HasSubstr("its opacity is nan"));
  EXPECT_THAT(trouble_with({false, {{std::nan(""), {}, 0}, high}}), HasSubstr("control point 1: its place"));
  EXPECT_THAT(trouble_with({false, {low, {1, {0, 2, 0}, 0}}}), HasSubstr("a component of 2"));
  EXPECT_THAT(trouble_with({false, {low, low}}), HasSubstr("different places"));
  EXPECT_THROW(control_points_named("nothing"), std::invalid_argument);
  EXPECT_THROW(sampled(control_points_named("grey"), 0, 1, 0), std::invalid_argument);
  for (const char* name : {"grey", "engine", "ct", "vessels", "rainbow"}) {
    EXPECT_EQ(trouble_with(control_points_named(name)), "") << name;
    EXPECT_THAT(built_in_control_points(), HasSubstr(name));
  }
}

TEST(TransferControlPoints, OpacityFollowsTheStepAndRunsLinearlyBetweenControlPoints) {
  const TransferControlPoints control_points{
      false, {{0, {0, 0, 0}, 0}, {0.5, {0.4, 0.6, 0.8}, 0.2}, {1, {1, 1, 1}, 1}}};
  const TransferFunction one = sampled(control_points, 10, 30, 1), half = sampled(control_points, 10, 30, 0.5);
  EXPECT_EQ(one.low, 10);
  EXPECT_EQ(one.high, 30);
  ASSERT_EQ(one.entries.size(), half.entries.size());
  const std::size_t last = one.entries.size() - 1;
  EXPECT_NEAR(one.entries[last / 4][3], 0.1, 1e-4);
  EXPECT_EQ(one.entries[last][3], 1);
  EXPECT_EQ(half.entries[last][3], 1);
  EXPECT_NEAR(one.entries[last / 2][0], 0.2 * 0.4, 1e-3) << "premultiplied";
  for (std::size_t i = 0; i <= last; i += 100) {
    const double twice = 1 - std::pow(1 - double(half.entries[i][3]), 2);
    EXPECT_NEAR(twice, one.entries[i][3], 1e-6) << "two half steps let through what one step does";
  }
  // A fog so thin that 1 - opacity is 1 in float is preserved.
  const TransferFunction fog =
      sampled(TransferControlPoints{true, {{0, {1, 1, 1}, 1e-12}, {1, {1, 1, 1}, 1e-12}}}, 0, 9, 0.5);
  EXPECT_FLOAT_EQ(fog.entries[7][3], 5e-13F);
  EXPECT_EQ(fog.high, 1) << "control points of values know no range";
  // Two control points at one position make a step.
  const TransferFunction step = sampled(
      TransferControlPoints{true,
                            {{0, {1, 1, 1}, 0}, {1, {1, 1, 1}, 0}, {1, {1, 1, 1}, 0.5}, {2, {1, 1, 1}, 0.5}}},
      0, 1, 1);
  EXPECT_EQ(step.entries[last / 2][3], 0);
  EXPECT_EQ(step.entries[last / 2 + 1][3], 0.5F);
}

TEST(TransferControlPoints, SpanARangeThatFloatsCanHold) {
  using Limits = std::numeric_limits<double>;
  const TransferControlPoints grey = control_points_named("grey");
  const VolumeDescription volume = describe({4, 4, 4}, TexelType::f32);
  RenderRequest request = orbit_request(volume, {1, 1, 1}, {0, 0, 4}, 4, 4, 1);
  const std::array<std::array<double, 2>, 6> ranges{{{3e7, 3e7 + 1},
                                                     {-3e7, -3e7 + 1},
                                                     {1e17, 1e17},
                                                     {0, 1e300},
                                                     {Limits::max(), Limits::max()},
                                                     {-Limits::max(), -Limits::max()}}};
  for (const auto& [low, high] : ranges) {
    request.classification = sampled(grey, low, high, 1);
    EXPECT_NO_THROW(validate(volume, request)) << low << " to " << high;
  }
  const TransferFunction constant = sampled(grey, 3e7, 3e7 + 1, 1);
  EXPECT_EQ(constant.low, 3e7F) << "a constant volume has the value of the lower end";
}

TEST(OrbitCamera, LooksAtTheMiddleFromEverySideAndFromThePoles) {
  VolumeDescription volume = describe({40, 30, 20}, TexelType::u8);
  for (const double azimuth : {0.0, 90.0, 200.0})
    for (const double elevation : {-90.0, 0.0, 35.0, 90.0}) {
      const RenderRequest request = orbit_request(volume, {1, 1, 2}, {azimuth, elevation, 4}, 60, 40, 1);
      const Vec4 middle = transform_point(request.texture_to_clip, {0.5, 0.5, 0.5});
      EXPECT_NEAR(middle[0] / middle[3], 0, 1e-12);
      EXPECT_NEAR(middle[1] / middle[3], 0, 1e-12);
      EXPECT_NEAR(middle[3], 4, 1e-12);
      EXPECT_NO_THROW(validate(volume, [&] {
        RenderRequest with_table = request;
        with_table.classification = smooth_table();
        return with_table;
      }()));
      for (int corner = 0; corner < 8; ++corner) {
        const Vec4 c = transform_point(request.texture_to_clip,
                                       {double(corner & 1), double(corner >> 1 & 1), double(corner >> 2 & 1)});
        for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(c[std::size_t(k)]), c[3] * 1.0001) << "in sight";
      }
    }
  // Angle 0 looks along y: x to the right, z up.
  const Matrix4 front = orbit_request(volume, {1, 1, 1}, {0, 0, 4}, 50, 50, 1).texture_to_clip;
  EXPECT_GT(transform_point(front, {1, 0.5, 0.5})[0], 0.1);
  EXPECT_GT(transform_point(front, {0.5, 0.5, 1})[1], 0.1);
  EXPECT_LT(transform_point(front, {0.5, 0, 0.5})[3], transform_point(front, {0.5, 1, 0.5})[3]);
  // A camera that leans to the left sees the world lean to the right.
  const Matrix4 rolled = orbit_request(volume, {1, 1, 1}, {0, 0, 4, 90}, 50, 50, 1).texture_to_clip;
  EXPECT_LT(transform_point(rolled, {1, 0.5, 0.5})[1], -0.1);
  EXPECT_NEAR(transform_point(rolled, {1, 0.5, 0.5})[0], 0, 1e-12);
  const Matrix4 upside_down = orbit_request(volume, {1, 1, 1}, {0, 0, 4, 180}, 50, 50, 1).texture_to_clip;
  EXPECT_LT(transform_point(upside_down, {0.5, 0.5, 1})[1], -0.1);
  EXPECT_LT(transform_point(upside_down, {1, 0.5, 0.5})[0], -0.1);
}

TEST(OrbitCamera, StepsAreInVoxels) {
  const Texture texture = sampled(describe({32, 32, 32}, TexelType::u8), constant_field(1));
  const BrickStore store = filled(texture);
  for (const double step : {0.5, 1.0, 2.0}) {
    RenderRequest request = orbit_request(texture.description, {1, 1, 1}, {0, 0, 1000}, 1, 1, step);
    request.classification =
        sampled(TransferControlPoints{true, {{0, {1, 1, 1}, 0.02}, {1, {1, 1, 1}, 0.02}}}, 0, 1, step);
    Image image(request.window);
    FrameCounts counts;
    raycast(store, request, image, counts);
    EXPECT_NEAR(double(counts.samples), 32 / step, 1);
    EXPECT_NEAR(image.rgba[3], 1 - std::pow(0.98, 32), 0.01) << "whatever the step";
  }
}

TEST(OrbitCamera, WhatMakesNoSenseIsRefused) {
  const VolumeDescription volume = describe({8, 8, 8}, TexelType::u8);
  const Vec3 unit{1, 1, 1};
  EXPECT_THROW(orbit_request(volume, unit, {0, 91, 4}, 10, 10, 1), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {0, 0, 4, std::nan("")}, 10, 10, 1), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {0, 0, 0}, 10, 10, 1), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {std::nan(""), 0, 4}, 10, 10, 1), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {0, 0, 4}, 0, 10, 1), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {0, 0, 4}, 10, 10, 0), std::invalid_argument);
  EXPECT_THROW(orbit_request(volume, unit, {0, 0, 4}, 10, 10, std::nan("")), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
