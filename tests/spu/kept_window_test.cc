// SPDX-License-Identifier: Apache-2.0
// Ray casters that discard fragments by their place in the window: the first image is right already, wherever
// the volume is seen, and no comparison has to be lost for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "box_ray_caster.h"

namespace understudy::spu::testing {
namespace {

constexpr float window_edge = GlApplication::size;
constexpr double least_psnr = 50;  // dB

class ShownPart {
 public:
  explicit ShownPart(const MarchStyle& style) : app(GlApplication::start(Profile::core)), caster(style) {
    if (app) caster.set_up(*app);
  }

  std::vector<float> frame(bool under, double angle) {
    app->use_chain(under);
    caster.draw(*app, angle, 0);
    app->end_frame();
    return app->read_pixels();
  }

  void expect_alike(double angle, const std::string& what) {
    const auto before = app->substituted();
    const auto under = frame(true, angle);
    EXPECT_EQ(app->substituted(), before + 1) << what << ": " << app->last_reason();
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << what;
    const double likeness = psnr(under, frame(false, angle));
    std::printf("%s, %g degrees: %.3f dB\n", what.c_str(), angle, likeness);
    EXPECT_GE(likeness, least_psnr) << what << ", " << angle << " degrees";
  }

  std::unique_ptr<GlApplication> app;
  BoxRayCaster caster;
};

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
    ShownPart scene({.shown = part.corners, .distance = 1.45});
    if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
    for (const double angle : {20.0, 65.0, -40.0}) scene.expect_alike(angle, part.name);
  }
}

TEST(KeptWindow, IsMeasuredAgainWhereTheProgramMovesIt) {
  ShownPart scene({.shown = parts[0].corners, .distance = 1.45});
  if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  for (const Part& part : parts) {
    scene.caster.style.shown = part.corners;
    scene.expect_alike(20, part.name);
  }
  for (const Part& part : parts) {
    scene.caster.style.shown = part.corners;
    scene.expect_alike(-30, std::string(part.name) + ", again");
  }
}

TEST(KeptWindow, IsARectangle) {
  ShownPart scene({.shown_radius = 0.4F * window_edge, .distance = 1.45});
  if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  const auto under = scene.frame(true, 20);
  EXPECT_EQ(scene.app->substituted(), 0U);
  EXPECT_THAT(scene.app->last_reason(), ::testing::HasSubstr("do not fill a rectangle"));
  EXPECT_EQ(under, scene.frame(false, 20));
}

}  // namespace
}  // namespace understudy::spu::testing
