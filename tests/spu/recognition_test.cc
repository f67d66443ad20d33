// SPDX-License-Identifier: Apache-2.0
// The volume unit above a real driver: slices are recognised and substituted, and the image is the same.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "slice_scenes.h"
#include "spu/options.h"
#include "spu/report/counters.h"

namespace understudy::spu::testing {
namespace {

class Recognition : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    scene_ = all_slice_scenes()[GetParam()];
    start({});
  }

  void start(const Options& options) {
    app_.reset();
    app_ = GlApplication::start(scene_.profile, options);
    if (!app_) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
    scene_.set_up(*app_);
  }

  std::vector<float> frame(double angle, bool under) {
    app_->use_chain(under);
    scene_.draw(*app_, angle);
    app_->end_frame();
    return app_->read_pixels();
  }

  SliceScene scene_;
  std::unique_ptr<GlApplication> app_;
};

TEST_P(Recognition, GivesTheApplicationsImageFromEveryAngle) {
  for (const double angle : {0.0, 15.0, -40.0, 55.0}) {
    const auto before = app_->substituted();
    const auto under = frame(angle, true);
    EXPECT_EQ(app_->substituted(), before + 1)
        << scene_.name << ", angle " << angle << ": " << app_->last_reason();
    const auto bare = frame(angle, false);
    const double likeness = psnr(under, bare);
    std::printf("%s, %g degrees: %.1f dB\n", scene_.name.c_str(), angle, likeness);
    EXPECT_GE(likeness, 40) << scene_.name << ", angle " << angle;
    EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
  }
}

// Two frames: the first may have changed state that the application draws with.
TEST_P(Recognition, WithoutTheVolumeUnitTheImageIsBitIdentical) {
  Options options;
  options.chain = "track driver";
  start(options);
  const auto bare = frame(20, false);
  for (int number = 0; number < 2; ++number) EXPECT_EQ(frame(20, true), bare) << scene_.name;
  EXPECT_EQ(app_->substituted(), 0U);
}

TEST_P(Recognition, WithoutNodesTheImageIsBitIdentical) {
  Options options;
  options.connect = "no-such-socket";
  start(options);
  const auto bare = frame(20, false);
  for (int number = 0; number < 2; ++number) EXPECT_EQ(frame(20, true), bare) << scene_.name;
  EXPECT_EQ(app_->substituted(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Recognition, ::testing::Range<std::size_t>(0, all_slice_scenes().size()));

TEST(RecognitionOfChanges, ATextureUploadedAgainIsSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  const Blob blob;
  std::vector<std::uint8_t> half(std::size_t(blob.x * blob.y * 8), 200);
  app->gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  app->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 4, blob.x, blob.y, 8, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                          half.data());
  scene.draw(*app, 10);
  const auto under = app->read_pixels();
  app->use_chain(false);
  scene.draw(*app, 10);
  const auto bare = app->read_pixels();
  EXPECT_LT(psnr(before, under), 30) << "the upload changes nothing: the test tests nothing";
  EXPECT_GE(psnr(under, bare), 40);
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
}

/// What the new state affects need not be known.
TEST(RecognitionOfChanges, AKindOfStateThatIsNewAsksForAWholeComparison) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  const auto compared_after = [&] {
    scene.draw(*app, 10);
    return GlApplication::last_volume().verified_frames.load();
  };
  for (int frame = 0; frame < 4; ++frame) compared_after();
  const std::uint64_t compared = compared_after();
  app->gl().LineWidth(2);
  EXPECT_EQ(compared_after(), compared + 1);
  app->gl().LineWidth(3);
  EXPECT_EQ(compared_after(), compared + 1);
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
}

/// The other context uploads and never draws a frame.
TEST(RecognitionOfChanges, ATextureUploadedAgainByAnotherContextIsSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  GLint texture = 0;
  app->driver().GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
  std::thread([&] {
    const auto loader = app->start_companion();
    ASSERT_TRUE(loader);
    const Blob blob;
    const std::vector<std::uint8_t> half(std::size_t(blob.x * blob.y * 8), 200);
    loader->gl().BindTexture(GL_TEXTURE_3D, GLuint(texture));
    loader->gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    loader->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 4, blob.x, blob.y, 8, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                               half.data());
    loader->gl().Finish();
  }).join();
  app->gl().BindTexture(GL_TEXTURE_3D, GLuint(texture));
  scene.draw(*app, 10);
  const auto under = app->read_pixels();
  app->use_chain(false);
  scene.draw(*app, 10);
  EXPECT_LT(psnr(before, under), 30) << "the upload changes nothing: the test tests nothing";
  EXPECT_GE(psnr(under, app->read_pixels()), 40);
  EXPECT_EQ(app->substituted(), 2U) << app->last_reason();
}

TEST(RecognitionOfChanges, ATextureDefinedInOtherFormatsIsSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  const Blob blob;
  float share = 1;
  for (const GLint format : {GL_R16F, GL_R32F, GL_R16, GL_R8}) {
    share *= 0.8F;
    std::vector<float> values;
    for (const std::uint8_t s : blob.texels()) values.push_back(share * float(s) / 255);
    app->use_chain(true);
    app->gl().TexImage3D(GL_TEXTURE_3D, 0, format, blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT, values.data());
    scene.draw(*app, 10);
    app->end_frame();
    const auto under = app->read_pixels();
    app->use_chain(false);
    scene.draw(*app, 10);
    EXPECT_LT(psnr(before, under), 35) << "the new definition changes nothing: the test tests nothing";
    EXPECT_GE(psnr(under, app->read_pixels()), 40) << format;
  }
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
  EXPECT_EQ(app->substituted(), 5U);
}

TEST(RecognitionOfChanges, ATableUploadedAgainIsSeen) {
  auto app = GlApplication::start(Profile::core);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = core_batched();
  scene.set_up(*app);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) table.insert(table.end(), {1.0F, 0.0F, 0.0F, i > 128 ? 0.3F : 0.0F});
  app->gl().ActiveTexture(GL_TEXTURE1);
  app->gl().TexSubImage1D(GL_TEXTURE_1D, 0, 0, 256, GL_RGBA, GL_FLOAT, table.data());
  app->gl().ActiveTexture(GL_TEXTURE0);
  scene.draw(*app, 10);
  const auto under = app->read_pixels();
  app->use_chain(false);
  scene.draw(*app, 10);
  EXPECT_LT(psnr(before, under), 30);
  EXPECT_GE(psnr(under, app->read_pixels()), 40);
}

TEST(RecognitionOfFormats, EveryScalarFormatIsReadBackAndProbed) {
  struct Format {
    const char* name;
    GLenum internal_format;
    GLenum format;
    float scale;  ///< of the texels: float formats may exceed [0,1]
  };
  for (const Format& format :
       {Format{"R8", GL_R8, GL_RED, 1}, Format{"R16", GL_R16, GL_RED, 1}, Format{"R16F", GL_R16F, GL_RED, 1},
        Format{"R32F", GL_R32F, GL_RED, 1}, Format{"R32F up to 3", GL_R32F, GL_RED, 3},
        Format{"R16 up to 1/50", GL_R16, GL_RED, 0.02F}, Format{"R8_SNORM", GL_R8_SNORM, GL_RED, 1},
        Format{"R16_SNORM", GL_R16_SNORM, GL_RED, 1}, Format{"LUMINANCE16", GL_LUMINANCE16, GL_LUMINANCE, 1},
        Format{"INTENSITY16", GL_INTENSITY16, GL_LUMINANCE, 1}}) {
    auto app = GlApplication::start(Profile::compatibility);
    if (!app) GTEST_SKIP() << "no EGL context here";
    const SliceScene scene = client_arrays_table();
    scene.set_up(*app);
    const Blob blob;
    std::vector<float> texels;
    for (const std::uint8_t s : blob.texels()) texels.push_back(format.scale * float(s) / 255);
    app->gl().TexImage3D(GL_TEXTURE_3D, 0, GLint(format.internal_format), blob.x, blob.y, blob.z, 0,
                         format.format, GL_FLOAT, texels.data());
    scene.draw(*app, 30);
    const auto under = app->read_pixels();
    EXPECT_EQ(app->substituted(), 1U) << format.name << ": " << app->last_reason();
    app->use_chain(false);
    scene.draw(*app, 30);
    const double likeness = psnr(under, app->read_pixels());
    std::printf("%s: %.1f dB\n", format.name, likeness);
    EXPECT_GE(likeness, 40) << format.name;
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << format.name;
  }
}

TEST(RecognitionOfFormats, NotANumberInAFloatVolumeGivesAFiniteImage) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  const Blob blob;
  std::vector<float> texels(std::size_t(blob.x * blob.y * blob.z), 0.5F);
  for (std::size_t i = 0; i < texels.size(); i += 7) texels[i] = std::nanf("");
  texels[3] = INFINITY;
  app->gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R32F, blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT, texels.data());
  scene.draw(*app, 30);
  for (const float value : app->read_pixels()) ASSERT_TRUE(std::isfinite(value));
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

TEST(RecognitionOfDepth, OpaqueGeometryBeforeTheVolumeHidesIt) {
  for (const bool colours : {false, true}) {
    auto app = GlApplication::start(Profile::compatibility);
    if (!app) GTEST_SKIP() << "no EGL context here";
    const SliceScene scene = colours ? immediate_rgba() : client_arrays_table();
    scene.set_up(*app);
    const auto frame = [&](bool under, bool with_quad) {
      app->use_chain(under);
      app->gl().ClearColor(0, 0, 0, 0);
      app->gl().DepthMask(GL_TRUE);
      app->gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      app->gl().Enable(GL_DEPTH_TEST);
      for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
        app->gl().MatrixMode(matrix);
        app->gl().LoadIdentity();
      }
      app->gl().Begin(GL_QUADS);
      app->gl().Color4f(1, 1, 0, 1);
      // In front of everything on the left, behind everything on the right.
      for (const auto& [x, y, z] :
           {std::array{-0.9, -0.5, 0.1}, {0.9, -0.5, 0.9}, {0.9, 0.3, 0.9}, {-0.9, 0.3, 0.1}}) {
        if (with_quad) app->gl().Vertex3d(x, y, z);
      }
      app->gl().End();
      app->gl().DepthMask(GL_FALSE);
      scene.slices_and_tidy_up(*app, 25);
      app->end_frame();
      return app->read_pixels();
    };
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    const auto under = frame(true, true);
    EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
    const auto bare = frame(false, true);
    const auto without = frame(false, false);
    std::printf("%s, with an opaque quad: %.1f dB\n", scene.name.c_str(), psnr(under, bare));
    EXPECT_GE(psnr(under, bare), 40);
    EXPECT_LT(psnr(without, bare), 25) << "the quad hides nothing: the test tests nothing";
  }
}

TEST(RecognitionOfDepth, WhatTheSlicesWriteIsThereForWhoeverLooks) {
  for (const bool looks_at_it : {true, false}) {
    auto app = GlApplication::start(Profile::compatibility);
    if (!app) GTEST_SKIP() << "no EGL context here";
    const SliceScene scene = immediate_rgba();
    scene.set_up(*app);
    const auto frame = [&](bool under) {
      app->use_chain(under);
      app->gl().Enable(GL_DEPTH_TEST);
      app->gl().DepthMask(GL_TRUE);
      scene.draw(*app, 25);
      if (looks_at_it) {
        // Behind the volume's front: the slices' depth hides it.
        app->gl().Begin(GL_QUADS);
        app->gl().Color4f(0, 1, 0, 1);
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
          app->gl().Vertex3d(x, y, 0.5);
        app->gl().End();
      }
      auto image = app->read_pixels();
      app->end_frame();
      return image;
    };
    const auto bare = frame(false);
    for (int i = 0; i < 3; ++i) {
      const double likeness = psnr(frame(true), bare);
      std::printf("%s, frame %d: %.1f dB\n", looks_at_it ? "a quad behind the first slice" : "nothing more", i,
                  likeness);
      EXPECT_GE(likeness, 40) << "frame " << i;
    }
    EXPECT_EQ(app->substituted(), 3U) << app->last_reason();
  }
}

}  // namespace
}  // namespace understudy::spu::testing
