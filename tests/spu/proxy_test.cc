// SPDX-License-Identifier: Apache-2.0
// Ray casters in a fragment shader, recognised by what they draw: the image is the same, or the application's
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "ray_caster_scene.h"
#include "spu/report/counters.h"
#include "spu/volume/proxy/background_removal.h"
#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/sample_places.h"
#include "spu/volume/proxy/step_density.h"
#include "spu/volume/proxy/step_fit.h"
#include "spu/volume/proxy/table_contents.h"
#include "tests/all_cases.h"
#include "volume/matrix.h"
#include "volume/sampling.h"

namespace understudy::spu::testing {
namespace {

using Composition = MarchStyle::Composition;

struct Kind {
  const char* name;
  MarchStyle style;
};

std::vector<Kind> kinds() {
  const std::array<float, 3> stretched{1.0F, 1.3F, 0.7F};
  const std::array<float, 3> of_cubes{1.2F, 1.0F, 0.85F};  // texels of the blob
  return {
      {"over, premultiplied, steps of one length", {.extent = stretched}},
      {"over, straight colours, a way in equal parts",
       {.premultiplied = false, .divided = true, .extent = stretched}},
      {"over, parallel projection", {.parallel = true, .extent = of_cubes}},
      {"over, noise at the beginning of rays", {.noisy = true, .extent = stretched}},
      {"maximum, noise at the beginning of rays",
       {.composition = Composition::maximum, .noisy = true, .extent = stretched}},
      {"over, light from the eye", {.lit_from_eye = true, .extent = stretched}},
      {"over, light from the eye, gradients over a texel, straight colours",
       {.premultiplied = false,
        .lit_from_eye = true,
        .tap = {0.5F / 24, 0.5F / 20, 0.5F / 17},
        .extent = of_cubes}},
      {"over, light from the eye, of no ambient light, gradients over two texels",
       {.lit_from_eye = true, .ambient = 0, .tap = {1.0F / 24, 1.0F / 20, 1.0F / 17}, .extent = stretched}},
      {"over, light from the eye, gradients by the texture's size",
       {.lit_from_eye = true, .tap_of_a_texel = true, .extent = of_cubes}},
      {"over, alpha applied twice", {.alpha_twice = true, .extent = stretched}},
      {"over, face by face", {.face_by_face = true, .extent = stretched}},
      {"over, front and back faces", {.both_faces = true, .extent = stretched}},
      {"maximum, front and back faces",
       {.composition = Composition::maximum, .both_faces = true, .extent = of_cubes}},
      {"over, blending disabled", {.replaces = true, .discards = false, .extent = stretched}},
      {"over, blending disabled, front and back faces",
       {.replaces = true, .writes_depth = true, .discards = false, .both_faces = true, .extent = stretched}},
      {"over a background of the shader's own",
       {.background = {{0.9F, 0.3F, 0.5F}}, .discards = false, .extent = stretched}},
      {"over black in the shader, straight alpha",
       {.premultiplied = false, .background = {{0, 0, 0}}, .discards = false, .extent = stretched}},
      {"over white in the shader, blending disabled, front and back faces",
       {.replaces = true,
        .background = {{1, 1, 1}},
        .writes_depth = true,
        .discards = false,
        .both_faces = true,
        .extent = stretched}},
      {"over a background of the shader's own, front and back faces",
       {.background = {{0.2F, 0.7F, 0.4F}},
        .writes_depth = true,
        .discards = false,
        .both_faces = true,
        .extent = of_cubes}},
      {"rays that end at an opacity of 0.95", {.ends_at = 0.95F, .extent = of_cubes}},
      {"rays that end at an opacity of 0.7", {.ends_at = 0.7F, .extent = stretched}},
      {"the way from the eye alone", {.way_from_eye = true, .extent = of_cubes}},
      {"matched by location", {.matched_by_location = true, .extent = of_cubes}},
      {"maximum, blending disabled",
       {.composition = Composition::maximum, .replaces = true, .discards = false, .extent = of_cubes}},
      {"maximum", {.composition = Composition::maximum, .extent = of_cubes}},
      {"minimum", {.composition = Composition::minimum, .extent = of_cubes}},
      {"maximum, parallel projection",
       {.composition = Composition::maximum, .parallel = true, .extent = of_cubes}}};
}

TEST(Proxies, GiveTheApplicationsImageFromEveryAngle) {
  const std::vector<double> angles =
      takes_all_cases() ? std::vector{20.0, 35.0, -50.0, 110.0} : std::vector{20.0, -50.0};
  for (const Kind& kind : kinds()) {
    RayCasterScene scene(kind.style);
    if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
    for (const double angle : angles) {
      const auto before = scene.app->substituted();
      const auto under = scene.frame(true, angle);
      EXPECT_EQ(scene.app->substituted(), before + 1)
          << kind.name << ", angle " << angle << ": " << scene.app->last_reason();
      const double likeness = psnr(under, scene.frame(false, angle));
      std::printf("%s, %g degrees: %.1f dB\n", kind.name, angle, likeness);
      EXPECT_GE(likeness, 38) << kind.name << ", angle " << angle;
      EXPECT_EQ(scene.app->error(), GLenum(GL_NO_ERROR));
    }
    EXPECT_LT(psnr(scene.frame(false, 20), scene.frame(false, 110)), 30) << "the angle changes nothing";
  }
}

TEST(Proxies, WithoutBlendingDepthIsThatOfTheBox) {
  RayCasterScene scene({.replaces = true, .writes_depth = true, .discards = false});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  const auto depth_after = [&](bool under) {
    scene.frame(under, 20, 0.99F);
    constexpr GLsizei size = GlApplication::size;
    std::vector<float> depth(std::size_t(size) * size);
    scene.app->gl().ReadPixels(0, 0, size, size, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    return depth;
  };
  const auto under = depth_after(true);
  EXPECT_EQ(scene.app->substituted(), 1U) << scene.app->last_reason();
  EXPECT_TRUE(under == depth_after(false));
  EXPECT_NE(*std::min_element(under.begin(), under.end()), *std::max_element(under.begin(), under.end()));
}

TEST(Proxies, WithoutBlendingWhatCannotBeKnownIsNotSubstituted) {
  const std::vector<Kind> left = {
      {"whichever face is drawn last is left", {.replaces = true, .discards = false, .both_faces = true}},
      {"what is discarded replaces nothing", {.replaces = true}}};
  for (const Kind& kind : left) {
    RayCasterScene scene(kind.style);
    ASSERT_NE(scene.app, nullptr) << "no EGL context here";
    const auto under = scene.frame(true, 20);
    EXPECT_EQ(scene.app->substituted(), 0U) << kind.name;
    EXPECT_THAT(scene.app->last_reason(), ::testing::HasSubstr("blending is disabled")) << kind.name;
    EXPECT_TRUE(under == scene.frame(false, 20)) << kind.name;
  }
}

TEST(Proxies, TheShadersBackgroundMayChangeBetweenFrames) {
  RayCasterScene scene({.discards = false});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  std::optional<std::array<float, 3>>& background = scene.caster.style.background;
  for (const auto& colour :
       {std::optional<std::array<float, 3>>(), {{1, 1, 1}}, {{0, 0.25F, 0.5F}}, {{0, 0, 0}}}) {
    background = colour;
    const auto under = scene.frame(true, 20);
    EXPECT_GE(psnr(under, scene.frame(false, 20)), 38) << (colour ? (*colour)[2] : -1);
  }
  scene.caster.set_table(*scene.app, 0.5F);
  const auto under = scene.frame(true, 35);
  EXPECT_GE(psnr(under, scene.frame(false, 35)), 38) << "another table";
  EXPECT_EQ(scene.app->substituted(), 5U) << scene.app->last_reason();
}

TEST(Proxies, AShadersBackgroundThatIsAddedToWhatIsThereIsLeft) {
  RayCasterScene scene({.background = {{0.3F, 0.2F, 0.1F}}, .discards = false});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  scene.frame(true, 20);
  ASSERT_EQ(scene.app->substituted(), 1U) << scene.app->last_reason();
  scene.caster.style.adds = true;
  const auto under = scene.frame(true, 20);
  EXPECT_EQ(scene.app->substituted(), 1U);
  EXPECT_TRUE(under == scene.frame(false, 20));
}

TEST(Proxies, OpaqueFragmentsWhoseBoxIsNotSortedAreLeft) {
  const std::vector<Kind> left = {
      {"both are opaque", {.background = {{1, 1, 1}}, .discards = false, .both_faces = true}},
      {"the others are opaque", {.background = {{1, 1, 1}}}}};
  for (const Kind& kind : left) {
    RayCasterScene scene(kind.style);
    ASSERT_NE(scene.app, nullptr) << "no EGL context here";
    const auto under = scene.frame(true, 20);
    EXPECT_EQ(scene.app->substituted(), 0U) << kind.name;
    EXPECT_THAT(scene.app->last_reason(), ::testing::HasSubstr(kind.name));
    EXPECT_TRUE(under == scene.frame(false, 20)) << kind.name;
  }
}

TEST(Proxies, BlendingMayBeSwitchedBetweenFrames) {
  RayCasterScene scene({.discards = false});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  for (const bool disabled : {false, true, true, false}) {
    scene.caster.style.replaces = disabled;
    const auto under = scene.frame(true, 20);
    EXPECT_GE(psnr(under, scene.frame(false, 20)), 38) << (disabled ? "disabled" : "enabled");
  }
  EXPECT_EQ(scene.app->substituted(), 4U) << scene.app->last_reason();
}

TEST(Proxies, BackFacesThatAreDrawnLaterAreSeen) {
  RayCasterScene scene({.whole_rays = true});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  for (int i = 0; i < 6; ++i) scene.frame(true, 20);
  EXPECT_EQ(scene.app->substituted(), 6U) << scene.app->last_reason();
  const auto culled = scene.frame(false, 20);
  scene.caster.style.both_faces = true;
  const auto under = scene.frame(true, 20);
  const auto bare = scene.frame(false, 20);
  EXPECT_TRUE(under == bare) << psnr(under, bare) << " dB";
  EXPECT_LT(psnr(bare, culled), 35) << "back faces change nothing: the test tests nothing";
}

TEST(Proxies, OpacitiesAtWhichRaysEndAreMeasured) {
  for (const float limit : {0.95F, 0.8F, 0.6F}) {
    RayCasterScene scene(MarchStyle{.ends_at = limit});
    ASSERT_NE(scene.app, nullptr) << "no EGL context here";
    // Almost opaque samples, behind which much more would be visible.
    scene.caster.set_table(*scene.app, 0.3F);
    for (const double angle : {20.0, 65.0}) scene.expect_alike(angle, std::to_string(limit), 45);
  }
}

TEST(Proxies, AnotherOpacityAtWhichRaysEndIsSeen) {
  RayCasterScene scene(MarchStyle{.ends_at = 0.95F});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  scene.caster.set_table(*scene.app, 0.3F);
  for (const float limit : {0.95F, 0.6F, 0.999F, 0.8F, 0.95F}) {
    scene.caster.style.ends_at = limit;
    scene.expect_alike(20, std::to_string(limit), 45);
  }
}

TEST(Proxies, AnotherStepAndAnotherTableAreSeen) {
  RayCasterScene scene(MarchStyle{});
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  const auto before = scene.frame(true, 30);
  scene.caster.style.step = 0.06F;
  const auto coarse = scene.frame(true, 30);
  EXPECT_LT(psnr(before, coarse), 30) << "the step changes nothing: the test tests nothing";
  EXPECT_GE(psnr(coarse, scene.frame(false, 30)), 38);
  scene.app->use_chain(true);
  scene.caster.set_table(*scene.app, 0.9F);
  const auto dense = scene.frame(true, 30);
  EXPECT_LT(psnr(dense, coarse), 30) << "the table changes nothing: the test tests nothing";
  EXPECT_GE(psnr(dense, scene.frame(false, 30)), 38);
  EXPECT_EQ(scene.app->substituted(), 3U) << scene.app->last_reason();
}

TEST(Proxies, AStepThatIsAnotherInEveryFrameIsFollowed) {
  RayCasterScene scene(MarchStyle{});
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  double angle = 30;
  for (const float step : {0.02F, 0.05F, 0.031F, 0.074F, 0.02F}) {
    scene.caster.style.step = step;
    const auto under = scene.frame(true, angle);
    EXPECT_GE(psnr(under, scene.frame(false, angle)), 38) << "step " << step;
    angle += 7;
  }
  EXPECT_EQ(scene.app->substituted(), 5U) << scene.app->last_reason();
}

TEST(Proxies, AnotherStepBehindAnExtremeIsSeen) {
  constexpr double alike = 50;  // dB
  for (const auto composition : {Composition::maximum, Composition::minimum}) {
    RayCasterScene scene(MarchStyle{.composition = composition});
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    double angle = 30;
    double least = 100;
    for (const float step : {0.02F, 0.07F, 0.03F, 0.06F}) {
      const auto with_former_step = scene.frame(false, angle);
      scene.caster.style.step = step;
      const auto under = scene.frame(true, angle);
      const auto bare = scene.frame(false, angle);
      const double likeness = psnr(under, bare);
      std::printf("composition %d, step %g: %.1f dB\n", int(composition), double(step), likeness);
      EXPECT_GE(likeness, alike) << "step " << step;
      least = std::min(least, psnr(with_former_step, bare));
      angle += 7;
    }
    EXPECT_LT(least, alike) << "the step changes nothing: the test tests nothing";
    EXPECT_EQ(scene.app->substituted(), 4U) << scene.app->last_reason();
    EXPECT_EQ(GlApplication::last_volume().verify_lost, 0U);
  }
}

TEST(Proxies, NoiseAtTheBeginningOfRaysIsThatOfTheApplication) {
  for (const bool reads_depth : {false, true}) {
    RayCasterScene scene(MarchStyle{.noisy = true, .reads_depth = reads_depth, .step = 0.08F});
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    scene.caster.set_table(*scene.app, 0.9F);
    const auto first = scene.frame(true, 30);
    const auto bare = scene.frame(false, 30);
    const double likeness = psnr(first, bare);
    scene.app->use_chain(true);
    scene.caster.set_noise(*scene.app, 2);
    const auto second = scene.frame(true, 50);
    const double other_likeness = psnr(second, scene.frame(false, 50));
    std::printf("noise: %.1f dB, other noise: %.1f dB\n", likeness, other_likeness);
    EXPECT_GE(likeness, 58);
    EXPECT_GE(other_likeness, 58);
    EXPECT_EQ(scene.app->substituted(), 2U) << scene.app->last_reason();
    EXPECT_EQ(scene.app->error(), GLenum(GL_NO_ERROR));
    EXPECT_LT(psnr(scene.frame(false, 30), bare), 55) << "the noise changes nothing: the test tests nothing";
  }
}

/// As while a volume is rotated in ParaView, with steps of ten texels: near the box's silhouette the rays of
/// many pixels are shorter than a step.
TEST(Proxies, ShortRaysHaveASampleWhereTheProgramTakesOne) {
  for (const bool divided : {false, true}) {
    std::vector<std::vector<float>> images;
    for (const bool at_least_one : {false, true}) {
      MarchStyle style{.divided = divided, .noisy = !divided, .step = 0.08F};
      style.dense_rim = true;
      style.at_least_one = at_least_one;
      RayCasterScene scene(style);
      if (!scene.app) GTEST_SKIP() << "no EGL context here";
      scene.frame(true, 30);
      scene.caster.style.step = 0.2F;
      const auto under = scene.frame(true, 37);
      const auto bare = scene.frame(false, 37);
      std::printf("%s, %s: %.1f dB\n", divided ? "divided" : "noise", at_least_one ? "one at least" : "none",
                  psnr(under, bare));
      EXPECT_GE(psnr(under, bare), 42);
      EXPECT_EQ(scene.app->substituted(), 2U) << scene.app->last_reason();
      images.push_back(bare);
    }
    EXPECT_LT(psnr(images[0], images[1]), 40) << "one sample changes nothing: the test tests nothing";
  }
}

TEST(Proxies, NoiseIsReadThroughItsSamplerObject) {
  RayCasterScene scene(MarchStyle{.noisy = true, .noise_sampler = true, .step = 0.08F});
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  const auto under = scene.frame(true, 30);
  const auto bare = scene.frame(false, 30);
  EXPECT_GE(psnr(under, bare), 58);
  EXPECT_EQ(scene.app->substituted(), 1U) << scene.app->last_reason();
  EXPECT_EQ(scene.app->error(), GLenum(GL_NO_ERROR));
  scene.app->use_chain(false);
  scene.app->driver().BindSampler(3, 0);
  EXPECT_NE(scene.frame(false, 30), bare) << "the sampler changes nothing: the test tests nothing";
}

TEST(Proxies, RaysEndAtOpaqueGeometryWhoseDepthTheyRead) {
  RayCasterScene scene(MarchStyle{.reads_depth = true});
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  constexpr float through_the_middle = 0.877F;  // at distance 3, between planes at 0.5 and 10
  for (const double angle : {25.0, 60.0}) {
    const auto under = scene.frame(true, angle, through_the_middle);
    const auto bare = scene.frame(false, angle, through_the_middle);
    std::printf("a wall through the volume, %g degrees: %.1f dB\n", angle, psnr(under, bare));
    EXPECT_GE(psnr(under, bare), 38);
    EXPECT_LT(psnr(scene.frame(false, angle), bare), 30) << "the wall hides nothing: the test tests nothing";
  }
  EXPECT_EQ(scene.app->substituted(), 2U) << scene.app->last_reason();
}

TEST(Proxies, AreNotMeasuredAgainWhenOpaqueGeometryMoves) {
  // The wall's depth is copied into a texture in every frame.
  RayCasterScene scene(MarchStyle{.reads_depth = true});
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  constexpr std::uint64_t draws_to_check = 100;  // measuring a transfer function takes a thousand
  scene.frame(true, 25, 0.9F);
  for (const float wall : {0.88F, 0.87F, 0.86F, 0.85F}) {
    const std::uint64_t before = GlApplication::draws_of_arrays();
    scene.frame(true, 25, wall);
    EXPECT_LT(GlApplication::draws_of_arrays() - before, draws_to_check) << "a wall at a depth of " << wall;
  }
  EXPECT_EQ(scene.app->substituted(), 5U) << scene.app->last_reason();
}

/// A table with few entries whose kinks lie between the measured values.
void upload_coarse_table(GlApplication& app) {
  constexpr int entries = 16;
  std::vector<float> table;
  for (int i = 0; i < entries; ++i) {
    const float s = float(i) / (entries - 1);
    table.insert(table.end(), {0.5F + 0.5F * std::sin(20 * s), s, 1 - s, 0.9F * s * s});
  }
  app.gl().TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, entries, 0, GL_RGBA, GL_FLOAT, table.data());
}

TEST(Proxies, AreNotMeasuredAgainWhereTwoTablesTakeTurns) {
  RayCasterScene scene(MarchStyle{});
  ASSERT_NE(scene.app, nullptr) << "no EGL context here";
  constexpr std::uint64_t draws_to_check = 300;  // measuring a transfer function takes a thousand
  scene.app->use_chain(true);
  const DispatchTable& gl = scene.app->gl();
  gl.ActiveTexture(GL_TEXTURE1);
  GLint first = 0;
  gl.GetIntegerv(GL_TEXTURE_BINDING_1D, &first);
  GLuint second = 0;
  gl.GenTextures(1, &second);
  gl.BindTexture(GL_TEXTURE_1D, second);
  gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  upload_coarse_table(*scene.app);
  double angle = 30;
  for (int turn = 0; turn < 4; ++turn) {
    for (const GLuint table : {GLuint(first), second}) {
      scene.app->use_chain(true);
      gl.ActiveTexture(GL_TEXTURE1);
      gl.BindTexture(GL_TEXTURE_1D, table);
      gl.ActiveTexture(GL_TEXTURE0);
      const std::uint64_t before = GlApplication::draws_of_arrays();
      const auto under = scene.frame(true, angle);
      if (turn > 0) {
        EXPECT_LT(GlApplication::draws_of_arrays() - before, draws_to_check) << "turn " << turn;
      }
      EXPECT_GE(psnr(under, scene.frame(false, angle)), 38) << "turn " << turn << ", table " << table;
      angle += 7;
    }
  }
  EXPECT_EQ(scene.app->substituted(), 8U) << scene.app->last_reason();
}

TEST(Proxies, RaysThatDoNotEndAtGeometryInTheBoxAreLeft) {
  for (const bool replaces : {false, true}) {
    RayCasterScene scene({.replaces = replaces, .discards = !replaces});
    ASSERT_NE(scene.app, nullptr) << "no EGL context here";
    constexpr float through_the_middle = 0.877F;
    for (const float wall : {0.0F, 0.5F, through_the_middle, 0.99F}) {
      const auto under = scene.frame(true, 25, wall);
      EXPECT_GE(psnr(under, scene.frame(false, 25, wall)), 38) << "wall at " << wall;
    }
    // Without blending, the box is depth-tested like the application's.
    EXPECT_EQ(scene.app->substituted(), replaces ? 4U : 3U) << scene.app->last_reason();
  }
}

TEST(Proxies, WhatIsNotUnderstoodIsLeftBitIdentical) {
  struct Refusal {
    const char* reason;
    MarchStyle style;
  };
  for (const Refusal& refusal :
       {Refusal{"the samples of a ray are not composed by over (a plain sum, or lighting)",
                {.composition = Composition::sum}},
        Refusal{"the light does not shine from the eye", {.lit = true}},
        Refusal{"samples do not lie on constant steps from the box's faces (jitter, cropping)",
                {.jittered = true}},
        Refusal{"rays that begin at the back faces of the box show something, too",
                {.both_faces = true, .whole_rays = true}},
        Refusal{"the near plane cuts the ray caster's box, or the eye is inside", {.distance = 0.8}}}) {
    RayCasterScene scene(refusal.style);
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    for (int i = 0; i < 2; ++i) {
      const auto under = scene.frame(true, 20);
      EXPECT_EQ(scene.app->last_reason(), refusal.reason);
      const auto bare = scene.frame(false, 20);
      EXPECT_TRUE(under == bare) << refusal.reason << ": " << psnr(under, bare) << " dB";
      EXPECT_EQ(scene.app->error(), GLenum(GL_NO_ERROR)) << refusal.reason;
    }
    EXPECT_EQ(scene.app->substituted(), 0U) << refusal.reason;
  }
}

TEST(TableContents, TellACorrectedTableFromAnEditedOne) {
  constexpr double factor = 2.5;
  TableContents before{3, {}};
  TableContents corrected{3, {}};
  for (int i = 0; i < 1024; ++i) {
    const float opacity = float(i % 97) / 97;
    before.rgba.insert(before.rgba.end(), {0.5F, 0.25F, 0.0F, opacity});
    corrected.rgba.insert(corrected.rgba.end(), {0.5F, 0.25F, 0.0F, 1 - std::pow(1 - opacity, float(factor))});
  }
  const std::vector<TableContents> then{before};
  EXPECT_TRUE(only_corrected(then, then, factor));
  EXPECT_TRUE(only_corrected(then, std::vector{corrected}, factor));
  EXPECT_FALSE(only_corrected(then, std::vector{corrected}, 2.0));
  TableContents edited = corrected;
  edited.rgba[4 * 500 + 3] += 0.01F;
  EXPECT_FALSE(only_corrected(then, std::vector{edited}, factor)) << "one entry";
  TableContents another = corrected;
  another.sampler_location = 4;
  EXPECT_FALSE(only_corrected(then, std::vector{another}, factor));
  EXPECT_FALSE(only_corrected(then, {}, factor));
  EXPECT_FALSE(only_corrected(std::vector{TableContents{3, {}}}, std::vector{TableContents{3, {}}}, factor))
      << "of which nothing is known";
}

/// Differences from the background of rays with `samples` samples, each of opacity `alpha`.
std::vector<volume::Vec3> differences(const volume::Vec3& contrast, double alpha,
                                      const std::vector<double>& samples) {
  std::vector<volume::Vec3> all;
  for (const double n : samples) {
    volume::Vec3 difference = contrast;
    for (double& channel : difference) channel = double(float(channel * (1 - std::pow(1 - alpha, n))));
    all.push_back(difference);
  }
  return all;
}

TEST(BackgroundRemoval, TellsTheOpacityOfSamplesFromColours) {
  const std::vector<double> samples{1, 2, 3, 6, 14, 40};
  for (const double alpha : {1.0, 0.999, 0.7, 0.2, 0.03, 0.004, 0.0005}) {
    for (const volume::Vec3 full : {volume::Vec3{0.9, 0.1, -0.4}, volume::Vec3{-0.01, 0.02, 0.005}}) {
      const BackgroundContrast contrast = contrast_of(samples, differences(full, alpha, samples));
      // The opacity of a ray of 20 samples, computed from alpha and from the contrast.
      const auto of_twenty = differences(full, alpha, {20});
      EXPECT_NEAR(opacity_of(contrast, of_twenty.front()), 1 - std::pow(1 - alpha, 20),
                  0.002 + 3e-6 / (alpha * volume::length(full)))
          << alpha << " of " << full[0];
    }
  }
}

TEST(BackgroundRemoval, LeavesOutRaysThatEndEarly) {
  const std::vector<double> samples{1, 2, 3, 6, 14, 40};
  auto seen = differences({0.5, 0.5, -0.2}, 0.3, samples);
  seen[4] = seen[5] = seen[3];  // programs stop when little light is transmitted
  const BackgroundContrast contrast = contrast_of(samples, seen);
  EXPECT_NEAR(contrast.alpha, 0.3, 1e-3);
  EXPECT_NEAR(contrast.full[0], 0.5, 1e-3);
}

TEST(BackgroundRemoval, GivesBackWhatWasPutOverTheBackground) {
  const ShaderBackground background{{0.2, 0.9, 0.4}, 1};
  const volume::Rgba ray{0.3F, 0.1F, 0.05F, 0.4F};  // of samples with colour (0.75, 0.25, 0.125)
  const BackgroundContrast contrast{{0.75 - 0.2, 0.25 - 0.9, 0.125 - 0.4}, 0.1};
  const volume::Vec3 seen_difference =
      volume::subtract(colour_of(over_background(background, ray)), background.colour);
  const volume::Rgba seen =
      without_background(background, opacity_of(contrast, seen_difference), over_background(background, ray));
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(seen[c], ray[c], 1e-6) << c;
}

TEST(BackgroundRemoval, TellsTheOpacityOfTwoValues) {
  const BackgroundContrast near{{0.5, -0.2, 0.1}, 0.1};
  const BackgroundContrast far{{-0.1, 0.6, 0.3}, 0.2};
  // Opacity 0.4 in front of 0.7.
  const volume::Vec3 seen = volume::add(volume::scale(near.full, 0.4), volume::scale(far.full, 0.6 * 0.7));
  ASSERT_TRUE(opacity_of(near, far, seen).has_value());
  EXPECT_NEAR(*opacity_of(near, far, seen), 1 - 0.6 * 0.3, 1e-12);
  const BackgroundContrast nothing;
  EXPECT_NEAR(opacity_of(nothing, far, volume::scale(far.full, 0.7)).value_or(0), 0.7, 1e-12);
  const BackgroundContrast along_near{{0.25, -0.1, 0.05}, 0.1};
  EXPECT_FALSE(opacity_of(near, along_near, seen).has_value());
}

TEST(BackgroundRemoval, AValueThatShowsNothingHasNoContrast) {
  const std::vector<double> samples{1, 2, 3};
  EXPECT_FALSE(contrast_of(samples, std::vector<volume::Vec3>(3, volume::Vec3{1e-7, 0, 0})).visible());
}

TEST(StepFit, TellsCountsFromOpacities) {
  std::vector<double> opacities;
  std::vector<double> counts;
  for (int n = 1; n < 300; n += n % 7 + 1) {
    counts.push_back(n);
    opacities.push_back(double(float(1 - std::pow(1 - 0.0023, n))));
  }
  EXPECT_EQ(counts_from_opacities(opacities), counts);
  for (double& a : opacities) a = 0.002 * std::sqrt(a);  // increasing, but not a power
  EXPECT_TRUE(counts_from_opacities(opacities).empty());
  EXPECT_TRUE(counts_from_opacities(std::vector<double>{0.5, 1.0}).empty()) << "saturated";
}

TEST(StepFit, FindsTheMetricAndWhereTheFirstSampleLies) {
  const std::array<int, 3> texels{100, 80, 60};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  for (const std::array<double, 9>& metric : {std::array<double, 9>{120, 0, 0, 0, 96, 0, 0, 0, 72},
                                              {120, 0, 0, 0, 70, 0, 0, 0, 90},
                                              {100, 10, 0, 0, 140, 5, 0, 0, 70}}) {
    for (const double first : {0.0, 0.5, 1.0}) {
      std::vector<CountedRay> rays;
      const volume::RaySteps truth{metric, first};
      for (int i = 0; i < 2000; ++i) {
        const volume::Vec3 way{uniform(random), uniform(random), uniform(random)};
        rays.push_back({way, samples_of_length(truth, steps_of_way(truth, way))});
      }
      const auto fits = fit_steps(rays, std::vector{axes_in_texels(texels)});
      ASSERT_EQ(fits.size(), 1U) << metric[4] << ", first " << first;
      EXPECT_LE(fits[0].unexplained, most_unexplained);
      const volume::RaySteps rule = rules_of(fits[0]).front();
      EXPECT_EQ(rule.first, first);
      for (const CountedRay& ray : rays)
        EXPECT_NEAR(steps_of_way(rule, ray.way), steps_of_way(truth, ray.way), 0.2);
      // Rays with random starts within two steps cannot be explained.
      for (CountedRay& ray : rays) ray.samples += std::floor(2 * uniform(random));
      const auto jittered = fit_steps(rays, std::vector{axes_in_texels(texels)});
      ASSERT_EQ(jittered.size(), 1U);
      EXPECT_GT(jittered[0].unexplained, 0.05);
    }
  }
}

TEST(StepFit, RaysOfNearlyOneDirectionTellTheStepInTexels) {
  const volume::RaySteps truth{{120, 0, 0, 0, 96, 0, 0, 0, 72}, 1};
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  std::vector<CountedRay> rays;
  for (int i = 0; i < 500; ++i) {
    const double length = uniform(random);
    const volume::Vec3 way{0.8 * length, 0.5 * length, -0.3 * length};
    rays.push_back({way, samples_of_length(truth, steps_of_way(truth, way))});
  }
  const auto fits = fit_steps(rays, std::vector{volume::Vec3{100, 80, 60}});
  ASSERT_GE(fits.size(), 1U);
  const auto rule = rules_of(fits.front()).front();
  EXPECT_NEAR(steps_of_way(rule, {0, 1, 0}), 96, 0.5);
}

std::vector<SampledWay> ways_in_steps(double density, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<SampledWay> ways;
  for (int i = 0; i < 512; ++i) {
    const double whole = 0.2 + 0.8 * uniform(random);
    const double seen = (std::floor(whole * density) + 0.1 * (uniform(random) - 0.5)) / density;
    ways.push_back({whole, seen, whole - seen});
  }
  return ways;
}

TEST(StepDensity, IsFoundHoweverShortTheStepsAre) {
  std::mt19937 random(5);
  for (const double density : {5.3, 48.0, 331.7, 1500.0}) {
    const auto found = step_density(ways_in_steps(density, random));
    ASSERT_TRUE(found) << density;
    EXPECT_NEAR(*found, density, 0.05) << "of a step on the longest way";
  }
  EXPECT_FALSE(step_density(ways_in_steps(4000, random))) << "too short to be told";
}

TEST(StepDensity, IsNoneWhereSamplesLieAnywhere) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<SampledWay> ways = ways_in_steps(331.7, random);
  for (SampledWay& way : ways) way.sampled -= uniform(random) / 331.7;
  EXPECT_FALSE(step_density(ways));
  for (SampledWay& way : ways) way = {way.whole, way.whole, 0};
  EXPECT_FALSE(step_density(ways)) << "rays that end at their last sample";
  EXPECT_FALSE(step_density({}));
}

TEST(CountingAhead, TakesAsManySamplesAsTheProgramWherever) {
  // floor(L), round(L) and ceil(L) samples: the fitted offsets -1/2, 0 and 1/2.
  const auto rules = [](double offset) {
    return rules_counting_ahead({{1, 0, 0, 0, 1, 0, 0, 0, 1}, offset, 0});
  };
  for (const double offset : {-0.5, 0.0, 0.5}) EXPECT_EQ(rules(offset).size(), 2U) << offset;
  for (const volume::RaySteps& steps : rules(-0.5)) EXPECT_EQ(samples_of_length(steps, 7.3), 7);
  for (const volume::RaySteps& steps : rules(0)) EXPECT_EQ(samples_of_length(steps, 7.6), 8);
  for (const volume::RaySteps& steps : rules(0.5)) EXPECT_EQ(samples_of_length(steps, 7.3), 8);
  const auto ceil_in_middles = rules(0.5);
  ASSERT_TRUE(std::ranges::any_of(ceil_in_middles, [](const auto& steps) { return steps.first == 0.5; }));
  EXPECT_FALSE(std::ranges::any_of(ceil_in_middles, [](const auto& steps) { return steps.first == 0; }))
      << "which is the rule of constant steps";
}

TEST(SplitFields, AreSplitWithinTheTextureWhereverTheBoxLies) {
  const volume::Vec3 along{0.01, 0.02, -0.1};
  const auto fields_of = [&](double low, double high) {
    return split_fields({{0.4, 0.4, low}, {0.6, 0.6, high}}, along, 0.25F, 0.75F);
  };
  for (const auto& [low, high] : {std::pair{0.0, 1.0}, {0.95, 1.05}, {-0.05, 0.05}, {-0.1, 1.1}}) {
    const auto fields = fields_of(low, high);
    EXPECT_EQ(fields.size(), 2U) << low << " to " << high;
    for (const FieldProbe::SplitField& field : fields) {
      EXPECT_EQ(field.axis, 2U);
      EXPECT_GT(field.plane, std::max(low, 0.0)) << low << " to " << high;
      EXPECT_LT(field.plane, std::min(high, 1.0)) << low << " to " << high;
      EXPECT_EQ(field.before, 0.25F);
      EXPECT_EQ(field.behind, 0.75F);
    }
  }
  EXPECT_TRUE(fields_of(1.0, 1.05).empty());
  EXPECT_TRUE(fields_of(-0.05, -0.01).empty());
}

TEST(ProxyBox, IsWholeOrNone) {
  // A parallel camera that looks along (-1, -2, -3).
  const volume::Matrix4 camera{2, -1, 0, 0, 3, 6, -5, 0, -1, -2, -3, 0, 0, 0, 0, 1};
  const auto faces = [](const std::vector<std::size_t>& left_out) {
    ObservedPolygons polygons;
    for (std::size_t face = 0; face < 6; ++face) {
      if (std::find(left_out.begin(), left_out.end(), face) != left_out.end()) continue;
      for (const auto& [a, b] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        ObservedVertex v;
        v.texture[face / 2] = double(face % 2);
        v.texture[(face / 2 + 1) % 3] = a;
        v.texture[(face / 2 + 2) % 3] = b;
        polygons.vertices.push_back(v);
      }
      polygons.first.push_back(polygons.vertices.size());
    }
    return polygons;
  };
  EXPECT_TRUE(box_of(faces({}), camera));
  EXPECT_FALSE(box_of(faces({2}), camera)) << "one face is missing";
  EXPECT_TRUE(box_of(faces({0, 2, 4}), camera)) << "the eye sees only the other three";
  EXPECT_FALSE(box_of(faces({1, 2, 4}), camera)) << "a face that the eye sees is missing";
  EXPECT_FALSE(box_of(faces({0, 1, 2, 4}), camera)) << "a face that the eye sees is missing";
  auto dented = faces({});
  dented.vertices[5].texture = {0.5, 0.5, 0.5};
  EXPECT_FALSE(box_of(dented, camera));
}

}  // namespace
}  // namespace understudy::spu::testing
