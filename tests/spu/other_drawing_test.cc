// SPDX-License-Identifier: Apache-2.0
// Geometry before, inside and behind the volume, in perspective and parallel projection, compared with the
// driver's own drawing.
#include <gtest/gtest.h>

#include "drawing.h"

namespace understudy::spu::testing {
namespace {

/// One frame through the chain, one bypassing it, and one without the geometry under test.
struct Frames {
  std::vector<float> under;
  std::vector<float> bare;
  std::vector<float> without;
};

class OtherDrawing : public ::testing::TestWithParam<View> {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    load_colours(*app_);
  }

  template <class Frame>
  Frames frames(Frame draw) {
    const auto one = [&](bool under, bool with_geometry) {
      app_->use_chain(under);
      GlApplication& app = *app_;
      app.gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
      app.gl().ClearColor(0.1F, 0.1F, 0.2F, 1);
      app.gl().DepthMask(GL_TRUE);
      app.gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      app.gl().Enable(GL_DEPTH_TEST);
      look(app, GetParam(), 25);
      draw(app, with_geometry);
      auto pixels = app_->read_pixels();
      app_->end_frame();
      return pixels;
    };
    Frames all;
    all.under = one(true, true);
    EXPECT_EQ(app_->substituted(), 1U) << app_->last_reason();
    all.bare = one(false, true);
    all.without = one(false, false);
    EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
    return all;
  }

  static void expect_alike(const char* what, const Frames& frames) {
    std::printf("%s: %.1f dB\n", what, psnr(frames.under, frames.bare));
    EXPECT_GE(psnr(frames.under, frames.bare), 40) << what;
    EXPECT_LT(psnr(frames.without, frames.bare), 30) << what << " changes nothing: the test tests nothing";
  }

  std::unique_ptr<GlApplication> app_;
};

TEST_P(OtherDrawing, OpaqueGeometryThroughTheVolumeHidesWhatLiesBehindIt) {
  for (const bool writes_depth : {false, true}) {
    const auto before = app_->substituted();
    app_ = nullptr;
    SetUp();
    EXPECT_EQ(before, writes_depth ? 1U : 0U);
    expect_alike(writes_depth ? "opaque before, slices write depth" : "opaque before",
                 frames([&](GlApplication& app, bool with_geometry) {
                   if (with_geometry) draw_square(app, 0.6, 0.1, {1, 1, 0, 1});
                   app.gl().DepthMask(writes_depth);
                   draw_cube(app);
                 }));
  }
}

TEST_P(OtherDrawing, GeometryAfterTheVolumeBlendsOverIt) {
  expect_alike("translucent after", frames([](GlApplication& app, bool with_geometry) {
                 app.gl().DepthMask(GL_FALSE);
                 draw_cube(app);
                 if (!with_geometry) return;
                 app.gl().Enable(GL_BLEND);
                 draw_square(app, 0.7, 0.6, {1, 1, 0, 0.5F});
                 app.gl().Disable(GL_BLEND);
               }));
}

TEST_P(OtherDrawing, OpaqueGeometryAfterTheVolumeReplacesIt) {
  expect_alike("opaque after", frames([](GlApplication& app, bool with_geometry) {
                 app.gl().DepthMask(GL_FALSE);
                 draw_cube(app);
                 app.gl().DepthMask(GL_TRUE);
                 if (with_geometry) draw_square(app, 0.5, -0.2, {0, 1, 1, 1});
               }));
}

TEST_P(OtherDrawing, AScissorCutsTheVolume) {
  expect_alike("scissor", frames([](GlApplication& app, bool with_scissor) {
                 app.gl().Scissor(20, 30, 40, 37);
                 if (with_scissor) app.gl().Enable(GL_SCISSOR_TEST);
                 draw_cube(app);
                 app.gl().Disable(GL_SCISSOR_TEST);
               }));
}

INSTANTIATE_TEST_SUITE_P(In, OtherDrawing, ::testing::Values(View::perspective, View::parallel),
                         [](const auto& info) {
                           return info.param == View::perspective ? "Perspective" : "ParallelProjection";
                         });

}  // namespace
}  // namespace understudy::spu::testing
