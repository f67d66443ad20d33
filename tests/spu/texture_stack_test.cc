// SPDX-License-Identifier: Apache-2.0
// Stacks of 2-D textures that form a volume, and textured quads that do not.
#include <gtest/gtest.h>

#include "slice_scenes.h"
#include "spu/chain.h"

namespace understudy::spu::testing {
namespace {

std::vector<float> frame(GlApplication& app, const SliceScene& scene, double angle, bool under) {
  app.use_chain(under);
  scene.draw(app, angle);
  app.end_frame();
  return app.read_pixels();
}

TEST(TextureStacks, AreOneVolumeFromBothSides) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  std::uint64_t drawn = 0;
  for (const double angle : {10.0, 170.0, -30.0, 200.0}) {
    const auto under = frame(*app, scene, angle, true);
    EXPECT_EQ(app->substituted(), ++drawn) << angle << ": " << app->last_reason();
    const auto bare = frame(*app, scene, angle, false);
    std::printf("%g degrees: %.1f dB\n", angle, psnr(under, bare));
    EXPECT_GE(psnr(under, bare), 40) << angle;
  }
  EXPECT_EQ(app->left(), 0U);
}

TEST(TextureStacks, AChangedSliceIsSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  const auto before = frame(*app, scene, 10, true);
  const Blob blob;
  const std::vector<std::uint8_t> white(std::size_t(4 * blob.x * blob.y), 255);
  // The slice that was drawn last is still bound.
  app->gl().TexSubImage2D(GL_TEXTURE_2D, 0, 3, 3, 9, 9, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
  const auto under = frame(*app, scene, 10, true);
  EXPECT_EQ(app->substituted(), 2U) << app->last_reason();
  const auto bare = frame(*app, scene, 10, false);
  EXPECT_LT(psnr(before, under), 30) << "the change shows nothing: the test tests nothing";
  EXPECT_GE(psnr(under, bare), 40);
}

TEST(TextureStacks, ADeletedSliceThatComesAgainIsAnother) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  frame(*app, scene, 10, true);
  GLint last = 0;
  app->driver().GetIntegerv(GL_TEXTURE_BINDING_2D, &last);
  const auto texture = GLuint(last);
  app->gl().DeleteTextures(1, &texture);
  const Blob blob;
  const std::vector<std::uint8_t> white(std::size_t(4 * blob.x * blob.y), 255);
  app->gl().BindTexture(GL_TEXTURE_2D, texture);
  app->gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  app->gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  app->gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  app->gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, blob.x, blob.y, 0, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
  const auto under = frame(*app, scene, 10, true);
  EXPECT_GE(psnr(under, frame(*app, scene, 10, false)), 30);
}

TEST(TextureStacks, OfTexturesThatDifferAreLeftWithTheReason) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  const std::vector<std::uint8_t> grey(std::size_t{4} * 32 * 32, 100);
  app->gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 32, 32, 0, GL_RGBA, GL_UNSIGNED_BYTE, grey.data());
  const auto under = frame(*app, scene, 10, true);
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->last_reason(), "the stack's textures differ in size or format");
  EXPECT_EQ(under, frame(*app, scene, 10, false));
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

/// Like a desktop: many images of the same size, blended side by side.
TEST(TextureStacks, ImagesSideBySideAreNoVolumeAndNoWordIsSaid) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  texture_stack().set_up(*app);
  GLint last = 0;
  app->driver().GetIntegerv(GL_TEXTURE_BINDING_2D, &last);
  const auto desktop = [&](bool under) {
    app->use_chain(under);
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    app->gl().Enable(GL_BLEND);
    app->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    app->gl().Enable(GL_TEXTURE_2D);
    for (int i = 0; i < 12; ++i) {
      app->gl().BindTexture(GL_TEXTURE_2D, GLuint(last - i));
      app->gl().Begin(GL_QUADS);
      const int column = i % 4;
      const int row = i / 4;
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        app->gl().TexCoord2d(x, y);
        app->gl().Vertex2d(-0.9 + 0.4 * (column + x), -0.9 + 0.5 * (row + y));
      }
      app->gl().End();
    }
    GLint bound = 0;
    app->gl().GetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    EXPECT_EQ(bound, last - 11);
    app->gl().Disable(GL_TEXTURE_2D);
    app->gl().Disable(GL_BLEND);
    app->end_frame();
    return app->read_pixels();
  };
  const auto bare = desktop(false);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(desktop(true), bare) << "frame " << i;
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->left(), 0U);
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));

  EXPECT_EQ(Chain::current()->phase(), Phase::plain) << "nobody looks at draws any longer";
  EXPECT_EQ(desktop(true), bare);
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  EXPECT_EQ(Chain::current()->phase(), Phase::watching) << "other textures of one size may be a volume";
  app->gl().Clear(GL_COLOR_BUFFER_BIT);
  scene.draw(*app, 10);
  Chain::current()->settle();
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
}

TEST(TextureStacks, AreNotWaitedForForEver) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  for (int i = 0; i < 500; ++i) app->end_frame();
  scene.draw(*app, 10);
  app->end_frame();
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  for (int i = 0; i < 1000; ++i) app->end_frame();
  scene.draw(*app, 10);
  app->end_frame();
  EXPECT_EQ(app->substituted(), 2U) << "a stack that was drawn is waited for";

  auto other = GlApplication::start(Profile::compatibility);
  scene.set_up(*other);
  ASSERT_EQ(Chain::current()->phase(), Phase::watching);
  for (int i = 0; i < 700; ++i) other->end_frame();
  EXPECT_EQ(Chain::current()->phase(), Phase::plain);
}

}  // namespace
}  // namespace understudy::spu::testing
