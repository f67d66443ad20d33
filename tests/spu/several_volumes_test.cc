// SPDX-License-Identifier: Apache-2.0
// Several runs of slices in a frame: two volumes, two viewports, one texture drawn twice. With one viewport the
// frame is also compared with the emulation in double precision.
#include <gtest/gtest.h>

#include "drawing.h"
#include "emulated_scenes.h"

namespace understudy::spu::testing {
namespace {

class SeveralVolumes : public ::testing::Test {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  }

  /// load_colours() as drawn by draw_cube().
  static emulation::Volume cube(const emulation::Matrix& camera, bool mirrored = false) {
    std::vector<std::uint8_t> field = Blob().texels();
    if (mirrored) field.assign(field.rbegin(), field.rend());
    emulation::Volume volume =
        colour_cube(texels_of(field,
                              [&](int s) {
                                const int alpha_byte = s * s / 255 / 5;
                                const double alpha = alpha_byte / 255.0;
                                return mirrored ? std::array{40 / 255.0, s / 255.0, (255 - s) / 255.0, alpha}
                                                : std::array{s / 255.0, (255 - s) / 255.0, 90 / 255.0, alpha};
                              }),
                    0);
    volume.clip_from_texture = camera;
    volume.factor = {1, 1, 1, 1};
    return volume;
  }

  /// Draws two frames with and without the chain; every frame must substitute `runs` runs and show `volumes`.
  template <class Frame>
  void expect_alike(const char* what, std::uint64_t runs, Frame draw,
                    const std::vector<emulation::Volume>& volumes = {}) {
    const auto frame = [&](bool under) {
      app_->use_chain(under);
      GlApplication& app = *app_;
      app.gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
      app.gl().ClearColor(0.1F, 0.1F, 0.2F, 1);
      app.gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      draw(app);
      auto pixels = app_->read_pixels();
      app_->end_frame();
      return pixels;
    };
    const auto bare = frame(false);
    for (std::uint64_t i = 1; i <= 2; ++i) {
      const auto under = frame(true);
      EXPECT_EQ(app_->substituted(), i * runs) << what << ": " << app_->last_reason();
      if (volumes.empty()) {
        std::printf("%s, frame %d: %.1f dB\n", what, int(i), psnr(under, bare));
        EXPECT_GE(psnr(under, bare), 40) << what;
      } else {
        expect_within(what, shown_in_bytes(frame_of(volumes, {0.1F, 0.1F, 0.2F, 1})), under);
      }
    }
    EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
  }

  std::unique_ptr<GlApplication> app_;
};

TEST_F(SeveralVolumes, TwoTexturesInOneFrame) {
  const GLuint first = load_colours(*app_);
  const GLuint second = load_colours(*app_, true);
  expect_alike("two textures", 2,
               [&](GlApplication& app) {
                 look(app, View::perspective, 25, -0.3);
                 app.gl().BindTexture(GL_TEXTURE_3D, first);
                 draw_cube(app);
                 look(app, View::perspective, -20, 0.25);
                 app.gl().BindTexture(GL_TEXTURE_3D, second);
                 draw_cube(app);
               },
               {cube(cube_camera(25, false, -0.3)), cube(cube_camera(-20, false, 0.25), true)});
}

TEST_F(SeveralVolumes, TwoViewportsWithScissors) {
  load_colours(*app_);
  constexpr int half = GlApplication::size / 2;
  expect_alike("two viewports", 2, [&](GlApplication& app) {
    app.gl().Enable(GL_SCISSOR_TEST);
    for (const int side : {0, 1}) {
      app.gl().Viewport(side * half, 10, half, GlApplication::size - 10);
      app.gl().Scissor(side * half + 2, 0, half - 2, GlApplication::size);
      look(app, side == 0 ? View::perspective : View::parallel, 30 - 50 * side);
      draw_cube(app);
    }
    app.gl().Disable(GL_SCISSOR_TEST);
  });
}

TEST_F(SeveralVolumes, OneTextureDrawnTwice) {
  load_colours(*app_);
  emulation::Volume green = cube(cube_camera(-40, false, 0.3));
  green.factor = {0.4F, 1, 0.3F, 0.8F};
  expect_alike("one texture twice", 2,
               [&](GlApplication& app) {
                 look(app, View::perspective, 25, -0.2);
                 draw_cube(app);
                 look(app, View::perspective, -40, 0.3);
                 app.gl().Color4f(0.4F, 1, 0.3F, 0.8F);
                 draw_cube(app);
                 app.gl().Color4f(1, 1, 1, 1);
               },
               {cube(cube_camera(25, false, -0.2)), green});
}

TEST_F(SeveralVolumes, OneBehindTheOther) {
  const GLuint first = load_colours(*app_);
  const GLuint second = load_colours(*app_, true);
  expect_alike("one behind the other", 2,
               [&](GlApplication& app) {
                 app.gl().BindTexture(GL_TEXTURE_3D, first);
                 look(app, View::perspective, 20);
                 app.gl().Translated(0, 0, -1.2);
                 draw_cube(app);
                 app.gl().BindTexture(GL_TEXTURE_3D, second);
                 look(app, View::perspective, 20);
                 draw_cube(app);
               },
               {cube(cube_camera(20, false, 0, 1.2)), cube(cube_camera(20), true)});
}

}  // namespace
}  // namespace understudy::spu::testing
