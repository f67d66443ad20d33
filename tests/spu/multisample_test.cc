// SPDX-License-Identifier: Apache-2.0
// Slices into multisampled framebuffers, compared with the driver's own drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "box_ray_caster.h"
#include "colour_target.h"
#include "drawing.h"

namespace understudy::spu::testing {
namespace {

constexpr int samples = 4;

class Multisampled : public ::testing::Test {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    load_colours(*app_);
  }

  /// Draws one frame of `draw` into a multisampled framebuffer and resolves it.
  std::vector<float> frame(GLenum format, bool under, const std::function<void(GlApplication&)>& draw) {
    const ColourTarget target(*app_, format, samples);
    EXPECT_TRUE(target.complete());
    app_->use_chain(under);
    app_->gl().Enable(GL_MULTISAMPLE);
    app_->gl().DepthMask(GL_TRUE);
    target.clear({0.1F, 0.1F, 0.2F, 1});
    app_->gl().Enable(GL_DEPTH_TEST);
    look(*app_, View::perspective, 25);
    draw(*app_);
    app_->end_frame();
    return target.read();
  }

  std::unique_ptr<GlApplication> app_;
};

TEST_F(Multisampled, SlicesShowTheDriversImage) {
  for (const GLenum format : {GL_RGBA8, GL_RGBA16F, GL_RGBA32F}) {
    const auto draw = [](GlApplication& app) { draw_cube(app); };
    const auto under = frame(format, true, draw);
    EXPECT_EQ(app_->last_reason(), "");
    const auto bare = frame(format, false, draw);
    std::printf("%#x: %.1f dB\n", unsigned(format), psnr(under, bare));
    EXPECT_GE(psnr(under, bare), 40);
    EXPECT_LT(psnr(frame(format, false, [](GlApplication&) {}), bare), 30) << "there is nothing to be seen";
  }
  EXPECT_EQ(app_->substituted(), 3U);
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(Multisampled, OpaqueGeometryHidesWhatLiesBehindIt) {
  const auto draw = [](bool square) {
    return [square](GlApplication& app) {
      if (square) draw_square(app, 0.6, 0.1, {1, 1, 0, 1});
      draw_cube(app);
    };
  };
  const auto under = frame(GL_RGBA8, true, draw(true));
  EXPECT_EQ(app_->substituted(), 1U) << app_->last_reason();
  const auto bare = frame(GL_RGBA8, false, draw(true));
  std::printf("opaque geometry: %.1f dB\n", psnr(under, bare));
  EXPECT_GE(psnr(under, bare), 40);
  EXPECT_LT(psnr(frame(GL_RGBA8, false, draw(false)), bare), 30) << "the square changes nothing";
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

/// The edge of an object in front of a ray caster's box crosses pixels, and hides the box in some of their
/// samples.
TEST_F(Multisampled, ARayCastersBoxIsHiddenInSomeSamplesOfAPixel) {
  app_.reset();
  app_ = GlApplication::start(Profile::core);
  if (!app_) GTEST_SKIP() << "no EGL context of a core profile here";
  BoxRayCaster caster(MarchStyle{.half_a_wall = true});
  caster.set_up(*app_);
  const auto frame = [&](bool under) {
    const ColourTarget target(*app_, GL_RGBA8, samples);
    EXPECT_TRUE(target.complete());
    app_->use_chain(under);
    app_->gl().Enable(GL_MULTISAMPLE);
    constexpr float before_the_box = 0.3F;
    caster.draw(*app_, 25, before_the_box);
    app_->end_frame();
    return target.read();
  };
  const auto under = frame(true);
  EXPECT_EQ(app_->substituted(), 1U) << app_->last_reason();
  const auto bare = frame(false);
  double most = 0;
  for (std::size_t i = 0; i < bare.size(); ++i)
    most = std::max(most, std::abs(double(bare[i]) - double(under[i])));
  std::printf("behind an edge: %.1f dB, at most %.3f\n", psnr(under, bare), most);
  EXPECT_GE(psnr(under, bare), 45);
  EXPECT_LE(most, 0.03) << "an image that covers all samples of a pixel shows half of the edge: 0.2";
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(Multisampled, WhatTellsSamplesApartIsLeft) {
  struct Refused {
    GLenum capability;
    const char* reason;
  };
  for (const Refused& refused :
       {Refused{GL_SAMPLE_ALPHA_TO_COVERAGE, "opacity becomes the coverage of a multisampled framebuffer"},
        Refused{GL_SAMPLE_ALPHA_TO_ONE, "opacity becomes the coverage of a multisampled framebuffer"},
        Refused{GL_SAMPLE_COVERAGE, "only some samples of a multisampled framebuffer are drawn"},
        Refused{GL_SAMPLE_MASK, "only some samples of a multisampled framebuffer are drawn"},
        Refused{GL_SAMPLE_SHADING, "the samples of a multisampled framebuffer are shaded one by one"}}) {
    const auto draw = [&](GlApplication& app) {
      app.gl().Enable(refused.capability);
      draw_cube(app);
      app.gl().Disable(refused.capability);
    };
    const auto under = frame(GL_RGBA8, true, draw);
    EXPECT_EQ(app_->substituted(), 0U) << refused.reason;
    EXPECT_EQ(app_->last_reason(), refused.reason);
    EXPECT_EQ(under, frame(GL_RGBA8, false, draw)) << refused.reason;
  }
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
