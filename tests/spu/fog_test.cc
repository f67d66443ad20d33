// SPDX-License-Identifier: Apache-2.0
// Fog: measured from colours, recognised above a real driver, and distinguished from effects that resemble it.
#include "spu/volume/classification/fog.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "slice_scenes.h"
#include "spu/report/counters.h"
#include "volume/rgba.h"

namespace understudy::spu::testing {
namespace {

using volume::Rgba;

/// 64 entries with various colours; the first ones are clear.
std::vector<Rgba> some_table() {
  std::vector<Rgba> table;
  for (int i = 0; i < 64; ++i) {
    const float s = float(i) / 63;
    table.push_back({s, 0.5F + 0.5F * std::sin(7 * s), 1 - s, i < 8 ? 0.0F : 0.3F * s});
  }
  return table;
}

std::vector<float> some_numbers() {
  std::vector<float> numbers;
  for (int i = 0; i <= 300; ++i) numbers.push_back(2.0F + 0.01F * float(i));
  return numbers;
}

/// Colour that a shader produces with fog of density `density` beyond 3.
Rgba behind_fog(Rgba colour, float number, float density) {
  const float weight = std::exp(-density * std::max(number - 3, 0.0F));
  const Rgba haze{0.2F, 0.4F, 0.9F, 0};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = weight * colour[c] + (1 - weight) * haze[c];
  return colour;
}

TEST(MeasureFog, FindsWeightAndColourAtEveryDistance) {
  const auto table = some_table();
  const auto numbers = some_numbers();
  const auto fog = measure_fog(table, false, numbers, {2, 5}, [&](std::size_t entry) {
    std::vector<Rgba> seen(numbers.size());
    std::ranges::transform(numbers, seen.begin(),
                           [&](float number) { return behind_fog(table[entry], number, 0.8F); });
    return seen;
  });
  ASSERT_TRUE(fog);
  EXPECT_EQ(fog->low, 2.0F);
  EXPECT_NEAR(fog->high, 5.0F, 1e-4);
  const double last = double(fog->entries.size() - 1);
  for (std::size_t i = 0; i < fog->entries.size(); ++i) {
    const double number = fog->low + (double(fog->high) - fog->low) * double(i) / last;
    const double weight = std::exp(-0.8 * std::max(number - 3, 0.0));
    EXPECT_NEAR(fog->entries[i][3], weight, 1e-4) << "at " << number;
    EXPECT_NEAR(fog->entries[i][2], 0.9 * (1 - weight), 1e-4) << "at " << number;
  }
}

TEST(MeasureFog, IsNoneWhereOpacityFades) {
  const auto table = some_table();
  const auto numbers = some_numbers();
  EXPECT_FALSE(measure_fog(table, false, numbers, {2, 5}, [&](std::size_t entry) {
    std::vector<Rgba> seen;
    for (const float number : numbers) {
      Rgba colour = table[entry];
      colour[3] *= 5 - number;
      seen.push_back(colour);
    }
    return seen;
  }));
}

TEST(MeasureFog, IsNoneWhereColoursTurnIntoOneAnother) {
  const auto table = some_table();
  const auto numbers = some_numbers();
  EXPECT_FALSE(measure_fog(table, false, numbers, {2, 5}, [&](std::size_t entry) {
    std::vector<Rgba> seen;
    for (const float number : numbers) {
      Rgba colour = table[entry];
      if (number > 4) std::swap(colour[0], colour[1]);
      seen.push_back(colour);
    }
    return seen;
  }));
}

/// Outside the sampled range, fog need not explain clamped colours: the measured range ends there.
TEST(MeasureFog, EndsWhereColoursAreClampedAndNoneIsNeeded) {
  const auto table = some_table();
  const auto numbers = some_numbers();
  const auto colours = [&](std::size_t entry) {
    std::vector<Rgba> seen;
    for (const float number : numbers) {
      Rgba colour = table[entry];
      for (std::size_t c = 0; c < 3; ++c) colour[c] = 0.9F + (4 - number) * (colour[c] - 0.9F);
      seen.push_back(colour);
    }
    return seen;
  };
  const auto fog = measure_fog(table, false, numbers, {3.1F, 3.9F}, colours);
  ASSERT_TRUE(fog);
  EXPECT_LT(fog->low, 3.1F);
  EXPECT_GT(fog->low, 2.5F);
  EXPECT_GT(fog->high, 3.9F);
  EXPECT_LT(fog->high, 4.5F);
  EXPECT_FALSE(measure_fog(table, false, numbers, {3.1F, 4.6F}, colours));
}

std::string explanation() {
  return GlApplication::last_volume().explanation;
}

std::uint64_t probes() {
  return GlApplication::last_volume().probes;
}

TEST(Fog, IsProbedOnceWhileTheViewTurns) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = fogged_polygons();
  scene.set_up(*app);
  for (int angle = -30; angle <= 30; angle += 5) {
    scene.draw(*app, angle);
    app->end_frame();
  }
  EXPECT_EQ(app->substituted(), 13U) << app->last_reason();
  EXPECT_EQ(probes(), 1U);
  EXPECT_NE(explanation().find("fog"), std::string::npos) << explanation();
}

TEST(Fog, OfAnotherColourIsProbedAgain) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = fogged_polygons();
  scene.set_up(*app);
  scene.draw(*app, 10);
  app->end_frame();
  const auto before = app->read_pixels();
  app->gl().UseProgram(1);
  app->gl().Uniform3f(app->gl().GetUniformLocation(1, "background"), 0, 0.1F, 0.9F);
  app->gl().UseProgram(0);
  scene.draw(*app, 10);
  app->end_frame();
  const auto under = app->read_pixels();
  app->use_chain(false);
  scene.draw(*app, 10);
  EXPECT_LT(psnr(before, under), 35) << "the colour of the fog shows nowhere: the test tests nothing";
  EXPECT_GE(psnr(under, app->read_pixels()), 40);
  EXPECT_EQ(app->substituted(), 2U) << app->last_reason();
  EXPECT_EQ(probes(), 2U);
}

TEST(Fog, OverColoursInTheTexelsIsMeasured) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  const std::array<GLfloat, 4> haze{0.9F, 0.3F, 0.1F, 1};
  app->gl().Fogi(GL_FOG_MODE, GL_EXP2);
  app->gl().Fogf(GL_FOG_DENSITY, 0.25F);
  app->gl().Fogfv(GL_FOG_COLOR, haze.data());
  for (const double angle : {-25.0, 10.0, 40.0}) {
    app->gl().Enable(GL_FOG);
    app->use_chain(true);
    scene.draw(*app, angle);
    app->end_frame();
    const auto under = app->read_pixels();
    app->use_chain(false);
    scene.draw(*app, angle);
    const auto bare = app->read_pixels();
    app->gl().Disable(GL_FOG);
    scene.draw(*app, angle);
    EXPECT_LT(psnr(bare, app->read_pixels()), 35) << "the fog shows nowhere: the test tests nothing";
    std::printf("fog over colours, %g degrees: %.1f dB\n", angle, psnr(under, bare));
    EXPECT_GE(psnr(under, bare), 40) << angle;
  }
  EXPECT_EQ(app->substituted(), 3U) << app->last_reason();
  EXPECT_EQ(probes(), 1U);
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

TEST(Fog, ThatHidesTheVolumeIsLeft) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = vertex_shader_varying();
  scene.set_up(*app);
  // The varying named gain attenuates opacity by position: this is not fog.
  const char* source =
      "#version 120\n"
      "uniform mat4 camera; attribute vec3 corner; varying vec3 place; varying float gain;\n"
      "void main() { place = corner; gain = 0.3 + 0.5 * corner.z; gl_Position = camera * vec4(corner, 1.0); "
      "}\n";
  replace_shader(*app, GL_VERTEX_SHADER, source);
  scene.draw(*app, 20);
  const auto under = app->read_pixels();
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->last_reason(), "the colour depends on more than the sample (position, lighting)");
  app->use_chain(false);
  scene.draw(*app, 20);
  EXPECT_EQ(under, app->read_pixels());
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
