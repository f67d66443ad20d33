// SPDX-License-Identifier: Apache-2.0
#include "ray_caster_scene.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace understudy::spu::testing {

RayCasterScene::RayCasterScene(const MarchStyle& style)
    : app(GlApplication::start(Profile::core)), caster(style) {
  if (app) caster.set_up(*app);
}

std::vector<float> RayCasterScene::frame(bool under, double angle, float wall) {
  app->use_chain(under);
  caster.draw(*app, angle, wall);
  app->end_frame();
  return app->read_pixels();
}

std::vector<float> RayCasterScene::expect_alike(double angle, const std::string& what, double least) {
  const auto before = app->substituted();
  const auto under = frame(true, angle);
  EXPECT_EQ(app->substituted(), before + 1) << what << ": " << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << what;
  auto bare = frame(false, angle);
  const double likeness = psnr(under, bare);
  std::printf("%s, %g degrees: %.1f dB\n", what.c_str(), angle, likeness);
  EXPECT_GE(likeness, least) << what << ", " << angle << " degrees";
  return bare;
}

}  // namespace understudy::spu::testing
