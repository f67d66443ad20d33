// SPDX-License-Identifier: Apache-2.0
// Less common ways of slicing above a real driver, compared in float framebuffers with the application's own
// drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "colour_target.h"
#include "slice_scenes.h"
#include "spu/report/counters.h"

namespace understudy::spu::testing {
namespace {

std::vector<float> frame(GlApplication& app, const ColourTarget& target, const SliceScene& scene, double angle,
                         bool under) {
  app.use_chain(under);
  target.clear({0, 0, 0, 0});
  scene.slices_and_tidy_up(app, angle);
  app.end_frame();
  return target.read();
}

/// Slices with a mipmap filter whose samples come from level 0 only; `limit` restricts the levels.
SliceScene slices_of_one_level(void (*limit)(const DispatchTable&)) {
  SliceScene scene = immediate_rgba();
  scene.set_up = [limit, set_up_texture = scene.set_up](GlApplication& app) {
    set_up_texture(app);
    app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    limit(app.gl());
  };
  return scene;
}

void cut_levels(const DispatchTable& gl) {
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
}

struct Variant {
  const char* name;
  std::function<SliceScene()> scene;
  std::vector<double> angles;
  double least_psnr;  ///< dB, in a float framebuffer
  const char* told;   ///< text that the explanation contains
};

class SlicingVariants : public ::testing::TestWithParam<Variant> {};

TEST_P(SlicingVariants, GiveTheApplicationsImageInFloat) {
  const SliceScene scene = GetParam().scene();
  auto app = GlApplication::start(scene.profile);
  if (!app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  scene.set_up(*app);
  const ColourTarget target(*app, GL_RGBA32F);
  ASSERT_TRUE(target.complete());
  std::uint64_t drawn = 0;
  for (const double angle : GetParam().angles) {
    const auto under = frame(*app, target, scene, angle, true);
    EXPECT_EQ(app->substituted(), ++drawn) << angle << ": " << app->last_reason();
    const auto bare = frame(*app, target, scene, angle, false);
    EXPECT_GT(*std::max_element(bare.begin(), bare.end()), 0.2F) << "there is something to see";
    std::printf("%s, %g degrees: %.1f dB\n", scene.name.c_str(), angle, psnr(under, bare));
    EXPECT_GE(psnr(under, bare), GetParam().least_psnr) << angle;
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
  }
  const ProcessCounters& counters = process_counters();
  const std::string explanation =
      counters.volume[std::min<std::uint32_t>(counters.volumes, max_counted_volumes) - 1].explanation;
  EXPECT_NE(explanation.find(GetParam().told), std::string::npos) << explanation;
}

INSTANTIATE_TEST_SUITE_P(
    Of, SlicingVariants,
    ::testing::Values(
        Variant{"Segments",
                [] { return pre_integrated_slices(false); },
                {0, 15, -40, 55},
                60,
                "pre-integration table"},
        Variant{"SegmentsAlongRays",
                [] { return pre_integrated_slices(true); },
                {0, 15, -40},
                60,
                "pre-integration table"},
        Variant{"OneLevel", [] { return slices_of_one_level(cut_levels); }, {0, 15}, 45, "colours"},
        Variant{"LinearFog", [] { return fixed_function_fog(GL_LINEAR); }, {0, 15, -40}, 45, "fog"},
        Variant{"ExponentialFog", [] { return fixed_function_fog(GL_EXP); }, {0, 15, -40}, 45, "fog"},
        Variant{"SquaredFog", [] { return fixed_function_fog(GL_EXP2); }, {0, 15, -40}, 45, "fog"},
        Variant{"StackUnderGlsl",
                [] { return texture_stack_program(Profile::compatibility, GL_R8); },
                {10, 170, -30},
                45,
                "table probed from the program"},
        Variant{"StackOfFloats",
                [] { return texture_stack_program(Profile::compatibility, GL_R32F); },
                {10, 170, -30},
                60,
                "float texels"},
        Variant{"StackOfSixteenBits",
                [] { return texture_stack_program(Profile::core, GL_R16); },
                {10, 170, -30},
                45,
                "16-bit texels"},
        Variant{"StackInACoreProfile",
                [] { return texture_stack_program(Profile::core, GL_R8); },
                {10, 170, -30},
                45,
                "table probed from the program"},
        Variant{"ViewSpace", [] { return view_space_slices(); }, {0, 15, -40}, 45, "perspective"},
        Variant{"DegenerateStrip", [] { return degenerate_strip(); }, {0, 15, -40}, 45, "perspective"}),
    [](const auto& info) { return std::string(info.param.name); });

/// When the program's table changes, it is probed again.
TEST(Segments, OfAnotherTableAreProbedAgain) {
  const SliceScene scene = pre_integrated_slices(false);
  auto app = GlApplication::start(scene.profile);
  if (!app) GTEST_SKIP() << "no EGL context here";
  scene.set_up(*app);
  const ColourTarget target(*app, GL_RGBA32F);
  const auto before = frame(*app, target, scene, 15, true);
  std::vector<float> red;
  for (int i = 0; i < 256 * 256; ++i) red.insert(red.end(), {1, 0, 0, i % 256 > 128 ? 0.05F : 0.0F});
  app->gl().ActiveTexture(GL_TEXTURE1);
  app->gl().TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 256, GL_RGBA, GL_FLOAT, red.data());
  app->gl().ActiveTexture(GL_TEXTURE0);
  const auto under = frame(*app, target, scene, 15, true);
  EXPECT_EQ(app->substituted(), 2U) << app->last_reason();
  const auto bare = frame(*app, target, scene, 15, false);
  EXPECT_LT(psnr(before, bare), 30) << "the new table changes nothing: the test tests nothing";
  EXPECT_GE(psnr(under, bare), 45);
}

/// Draws once with Understudy and once without: nothing may be substituted, and no bit may differ.
void expect_left(GlApplication& app, const SliceScene& scene, const std::string& reason) {
  const ColourTarget target(app, GL_RGBA32F);
  const auto under = frame(app, target, scene, 15, true);
  EXPECT_EQ(app.substituted(), 0U);
  EXPECT_EQ(app.last_reason(), reason);
  EXPECT_EQ(under, frame(app, target, scene, 15, false));
  EXPECT_GT(*std::max_element(under.begin(), under.end()), 0.2F) << "there is something to see";
  EXPECT_EQ(app.error(), GLenum(GL_NO_ERROR));
}

TEST(Segments, ThatReachIntoARepetitionAreLeft) {
  const SliceScene scene = pre_integrated_slices(false);
  auto app = GlApplication::start(scene.profile);
  if (!app) GTEST_SKIP() << "no EGL context here";
  scene.set_up(*app);
  app->gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_WRAP_R, GL_REPEAT);
  expect_left(*app, scene, "segments reach beyond a repeating texture along axis 2");
}

TEST(Segments, WhoseColourDependsOnTheirPlaceAreLeft) {
  const SliceScene scene = pre_integrated_slices(false);
  auto app = GlApplication::start(scene.profile);
  if (!app) GTEST_SKIP() << "no EGL context here";
  scene.set_up(*app);
  const char* source =
      "#version 120\n"
      "uniform sampler3D field; uniform sampler2D table; varying vec3 front; varying vec3 back;\n"
      "void main() {\n"
      "  vec2 ends = vec2(texture3D(field, front).r, texture3D(field, back).r);\n"
      "  gl_FragColor = texture2D(table, (ends * 255.0 + 0.5) / 256.0) * (0.5 + 0.5 * back.y);\n"
      "}\n";
  replace_shader(*app, GL_FRAGMENT_SHADER, source);
  expect_left(*app, scene, "the colour depends on more than the sample (position, lighting)");
}

/// Many images of the same size, blended side by side by a program.
TEST(StacksUnderGlsl, ImagesSideBySideAreNoVolumeAndNoWordIsSaid) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  SliceScene scene = texture_stack_program(Profile::compatibility, GL_R8);
  scene.set_up(*app);
  GLint last = 0;
  app->driver().GetIntegerv(GL_TEXTURE_BINDING_2D, &last);
  scene.slices = [last](GlApplication& desktop, double) {
    desktop.gl().Enable(GL_BLEND);
    desktop.gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    desktop.gl().UseProgram(1);
    for (int i = 0; i < 12; ++i) {
      desktop.gl().BindTexture(GL_TEXTURE_2D, GLuint(last - i));
      desktop.gl().Begin(GL_QUADS);
      for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
        desktop.gl().TexCoord2d(x, y);
        const int row = i / 4;
        desktop.gl().Vertex2d(-0.9 + 0.4 * (i % 4 + x), -0.9 + 0.5 * (row + y));
      }
      desktop.gl().End();
    }
  };
  const ColourTarget target(*app, GL_RGBA8);
  const auto bare = frame(*app, target, scene, 0, false);
  for (int i = 0; i < 12; ++i) EXPECT_EQ(frame(*app, target, scene, 0, true), bare) << "frame " << i;
  EXPECT_GT(*std::max_element(bare.begin(), bare.end()), 0.1F) << "there is something to see";
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->left(), 0U);
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
