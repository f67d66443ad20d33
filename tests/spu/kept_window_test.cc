// SPDX-License-Identifier: Apache-2.0
// Ray casters that discard fragments by window position: the first image is already correct wherever the volume
// appears, without a failed comparison.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "ray_caster_scene.h"
#include "tests/all_cases.h"

namespace understudy::spu::testing {
namespace {

constexpr float window_edge = GlApplication::size;
constexpr double least_psnr = 50;  // dB

struct Part {
  const char* name;
  std::array<float, 4> corners;
};

constexpr std::array<Part, 6> parts{
    {{"without the lowest row", {0, 1, window_edge, window_edge}},
     {"without the column at the right", {0, 0, window_edge - 1, window_edge}},
     {"without a rim", {1, 1, window_edge - 1, window_edge - 1}},
     {"left of the middle", {0, 0, 0.4F * window_edge, window_edge}},
     {"a part in the middle", {20.2F, 31.7F, 70.4F, 67.9F}},
     {"a quarter", {0.5F * window_edge, 0.5F * window_edge, window_edge, window_edge}}}};

TEST(KeptWindow, IsMeasuredBeforeTheFirstImage) {
  for (const Part& part : parts) {
    RayCasterScene scene(MarchStyle{.shown = part.corners, .distance = 1.45});
    if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
    for (const double angle : takes_all_cases() ? std::vector{20.0, 65.0, -40.0} : std::vector{20.0})
      scene.expect_alike(angle, part.name, least_psnr);
  }
}

TEST(KeptWindow, IsMeasuredAgainWhereTheProgramMovesIt) {
  RayCasterScene scene(MarchStyle{.shown = parts[0].corners, .distance = 1.45});
  if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  const std::size_t step = takes_all_cases() ? 1 : 2;
  for (std::size_t i = 0; i < parts.size(); i += step) {
    scene.caster.style.shown = parts[i].corners;
    scene.expect_alike(20, parts[i].name, least_psnr);
  }
  for (std::size_t i = 0; i < parts.size(); i += step) {
    scene.caster.style.shown = parts[i].corners;
    scene.expect_alike(-30, std::string(parts[i].name) + ", again", least_psnr);
  }
}

TEST(KeptWindow, IsARectangle) {
  RayCasterScene scene(MarchStyle{.shown_radius = 0.4F * window_edge, .distance = 1.45});
  if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  const auto under = scene.frame(true, 20);
  EXPECT_EQ(scene.app->substituted(), 0U);
  EXPECT_THAT(scene.app->last_reason(), ::testing::HasSubstr("do not fill a rectangle"));
  EXPECT_EQ(under, scene.frame(false, 20));
}

}  // namespace
}  // namespace understudy::spu::testing
