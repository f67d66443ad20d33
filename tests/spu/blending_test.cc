// Slices under every blending that the nodes know, into framebuffers of several formats, against the driver's
// own drawing of the same slices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "colour_target.h"
#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

struct Case {
  const char* name;
  SliceBlending blending;
  std::array<float, 4> background{0.1F, 0.2F, 0.3F, 0.0F};
};

SliceBlending factors(GLenum colour_source, GLenum colour_destination, GLenum alpha_source,
                      GLenum alpha_destination, bool front_to_back = false) {
  return {[=](const DispatchTable& gl) {
            gl.BlendFuncSeparate(colour_source, colour_destination, alpha_source, alpha_destination);
          },
          front_to_back};
}

SliceBlending equations(GLenum colour, GLenum alpha) {
  return {[=](const DispatchTable& gl) {
    gl.BlendEquationSeparate(colour, alpha);
    gl.BlendFunc(GL_ONE, GL_ONE);
  }};
}

std::vector<Case> cases() {
  constexpr GLenum out = GL_ONE_MINUS_SRC_ALPHA;
  constexpr GLenum room = GL_ONE_MINUS_DST_ALPHA;
  constexpr std::array<float, 4> bright{0.9F, 0.8F, 0.7F, 0.6F};
  return {
      {"over", factors(GL_SRC_ALPHA, out, GL_SRC_ALPHA, out)},
      {"over, premultiplied", factors(GL_ONE, out, GL_ONE, out)},
      {"over, alpha as coverage", factors(GL_SRC_ALPHA, out, GL_ONE, out), bright},
      {"over, alpha into the room left", factors(GL_SRC_ALPHA, out, room, GL_ONE), bright},
      {"over, alpha kept", factors(GL_SRC_ALPHA, out, GL_ZERO, GL_ONE), bright},
      {"over, alpha summed", factors(GL_SRC_ALPHA, out, GL_ONE, GL_ONE)},
      {"over, squares of alpha summed", factors(GL_SRC_ALPHA, out, GL_SRC_ALPHA, GL_ONE)},
      {"over, greatest alpha", {[](const DispatchTable& gl) {
         gl.BlendEquationSeparate(GL_FUNC_ADD, GL_MAX);
         gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
       }}},
      {"under", factors(room, GL_ONE, room, GL_ONE, true), {0.1F, 0.2F, 0.3F, 0.4F}},
      {"under, alpha as coverage", factors(room, GL_ONE, GL_ONE, out, true)},
      {"under, alpha as transparency",
       factors(GL_DST_ALPHA, GL_ONE, GL_ZERO, out, true),
       {0.1F, 0.2F, 0.3F, 0.9F}},
      {"sum", factors(GL_ONE, GL_ONE, GL_ONE, GL_ONE)},
      {"sum of colours times alpha", factors(GL_SRC_ALPHA, GL_ONE, GL_SRC_ALPHA, GL_ONE)},
      {"sum, alpha kept", factors(GL_SRC_ALPHA, GL_ONE, GL_ZERO, GL_ONE), bright},
      {"sum, alpha as coverage", factors(GL_SRC_ALPHA, GL_ONE, GL_ONE, out)},
      {"maximum", equations(GL_MAX, GL_MAX)},
      {"maximum, alpha summed", equations(GL_MAX, GL_FUNC_ADD)},
      {"minimum", equations(GL_MIN, GL_MIN), bright},
      {"minimum, greatest alpha", equations(GL_MIN, GL_MAX), bright},
  };
}

struct Format {
  const char* name;
  GLenum internal_format;
  double likeness;  ///< dB that the driver's own arithmetic in this format allows
};

/// PSNR of pictures whose peak is their largest value, without the fiftieth of the pixels that differ most:
/// along their edges, the rasteriser counts samples to neighbouring pixels by its last bit.
double likeness(const std::vector<float>& a, const std::vector<float>& b) {
  const double peak = std::max(1.0F, *std::max_element(b.begin(), b.end()));
  std::vector<double> squares(a.size() / 4, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) squares[i / 4] += std::pow((double(a[i]) - b[i]) / peak, 2);
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 50);
  const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
  return sum > 0 ? -10 * std::log10(sum / double(4 * squares.size())) : std::numeric_limits<double>::infinity();
}

class EveryBlending : public ::testing::TestWithParam<Case> {
 protected:
  /// Draws one frame of the scene into a framebuffer of the format, bare or under the chain.
  static std::vector<float> frame(GlApplication& app, const ColourTarget& target, const SliceScene& scene,
                                  bool under) {
    app.use_chain(under);
    target.clear(GetParam().background);
    scene.slices_and_tidy_up(app, 25);
    app.end_frame();
    return target.read();
  }
};

TEST_P(EveryBlending, GivesTheDriversPictureInEveryColourFormat) {
  for (const bool colours : {false, true}) {
    for (const Format& format : {Format{"RGBA32F", GL_RGBA32F, 45}, Format{"RGBA16F", GL_RGBA16F, 45},
                                 Format{"RGBA16", GL_RGBA16, 50}, Format{"RGBA8", GL_RGBA8, 44}}) {
      auto app = GlApplication::start(Profile::compatibility);
      if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
      const SliceScene scene =
          colours ? immediate_rgba(GetParam().blending) : client_arrays_table(GetParam().blending);
      scene.set_up(*app);
      const ColourTarget target(*app, format.internal_format);
      ASSERT_TRUE(target.complete()) << format.name;
      const auto bare = frame(*app, target, scene, false);
      app->use_chain(false);
      target.clear(GetParam().background);
      const auto empty = target.read();
      const auto under = frame(*app, target, scene, true);
      EXPECT_EQ(app->substituted(), 1U) << format.name << ": " << app->last_reason();
      EXPECT_LT(likeness(empty, bare), 30) << "there is nothing to be seen";
      const double alike = likeness(under, bare);
      std::printf("%s, %s, %s: %.1f dB\n", GetParam().name, colours ? "colours" : "table", format.name, alike);
      EXPECT_GE(alike, format.likeness) << format.name;
      EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
    }
  }
}

/// Refusals: destination and blending do not go together, or it cannot be told that they do.
struct RefusedTarget {
  const char* name;
  GLenum internal_format;
  int samples;
  SliceBlending blending;
  const char* reason;
};

class RefusedTargets : public ::testing::TestWithParam<RefusedTarget> {};

TEST_P(RefusedTargets, AreLeftBitIdentical) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba(GetParam().blending);
  scene.set_up(*app);
  const ColourTarget target(*app, GetParam().internal_format, GetParam().samples);
  ASSERT_TRUE(target.complete());
  const auto frame = [&](bool under) {
    app->use_chain(under);
    target.clear({0.1F, 0.2F, 0.3F, 0.4F});
    scene.slices_and_tidy_up(*app, 25);
    app->end_frame();
    return target.read();
  };
  const auto under = frame(true);
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->last_reason(), GetParam().reason);
  EXPECT_EQ(under, frame(false));
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

INSTANTIATE_TEST_SUITE_P(
    Blending, RefusedTargets,
    ::testing::Values(
        RefusedTarget{"UnderWithoutAlpha", GL_RGB8, 0,
                      factors(GL_ONE_MINUS_DST_ALPHA, GL_ONE, GL_ONE_MINUS_DST_ALPHA, GL_ONE, true),
                      "the slices blend by a destination alpha that the framebuffer lacks or that is masked"},
        RefusedTarget{"UnderBackToFront", GL_RGBA8, 0,
                      factors(GL_ONE_MINUS_DST_ALPHA, GL_ONE, GL_ONE_MINUS_DST_ALPHA, GL_ONE),
                      "slices are drawn back to front under a front-to-back blend"},
        RefusedTarget{"OverFrontToBack", GL_RGBA8, 0,
                      factors(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA, true),
                      "slices are drawn front to back under a back-to-front blend"},
        RefusedTarget{"UnderWhoseAlphaIsASum", GL_RGBA8, 0,
                      factors(GL_ONE_MINUS_DST_ALPHA, GL_ONE, GL_ONE, GL_ONE, true),
                      "the slices blend front to back, but their alpha does not"},
        RefusedTarget{"OtherFactors", GL_RGBA8, 0,
                      factors(GL_DST_COLOR, GL_ZERO, GL_ONE, GL_ONE_MINUS_SRC_ALPHA),
                      "the blend function is none of over, under and sum"},
        RefusedTarget{"OtherFactorsOfAlpha", GL_RGBA8, 0,
                      factors(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ZERO),
                      "the blend function of alpha is neither over nor a sum"},
        RefusedTarget{"SignedTarget", GL_RGBA8_SNORM, 0, usual_blending(),
                      "the framebuffer's colours are neither normalised nor float"}),
    [](const auto& info) { return info.param.name; });

struct Destination {
  const char* name;
  GLenum internal_format;
  int samples;
  bool srgb;  ///< GL_FRAMEBUFFER_SRGB
  double likeness;
};

class Destinations : public ::testing::TestWithParam<Destination> {};

TEST_P(Destinations, ShowTheDriversPicture) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  const ColourTarget target(*app, GetParam().internal_format, GetParam().samples);
  if (!target.complete()) GTEST_SKIP() << "the driver does not draw into this format";
  const auto frame = [&](bool under, bool volume) {
    app->use_chain(under);
    app->gl().Disable(GL_MULTISAMPLE);
    if (GetParam().srgb) app->gl().Enable(GL_FRAMEBUFFER_SRGB);
    target.clear({0.1F, 0.2F, 0.3F, 0.4F});
    if (volume) scene.slices_and_tidy_up(*app, 25);
    app->end_frame();
    return target.read();
  };
  const auto under = frame(true, true);
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  const auto bare = frame(false, true);
  std::printf("%s: %.1f dB\n", GetParam().name, likeness(under, bare));
  EXPECT_GE(likeness(under, bare), GetParam().likeness);
  EXPECT_LT(likeness(frame(false, false), bare), 30) << "there is nothing to be seen";
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

INSTANTIATE_TEST_SUITE_P(
    Blending, Destinations,
    ::testing::Values(Destination{"RGBA8", GL_RGBA8, 0, false, 40}, Destination{"RGB8", GL_RGB8, 0, false, 40},
                      // Two bits of alpha: the driver's own slices are mostly rounded away.
                      Destination{"RGB10_A2", GL_RGB10_A2, 0, false, 25},
                      Destination{"R11F_G11F_B10F", GL_R11F_G11F_B10F, 0, false, 26},
                      Destination{"R8", GL_R8, 0, false, 40}, Destination{"RG16F", GL_RG16F, 0, false, 45},
                      Destination{"SrgbConverted", GL_SRGB8_ALPHA8, 0, true, 36},
                      Destination{"SrgbAsItIs", GL_SRGB8_ALPHA8, 0, false, 40},
                      Destination{"LinearUnderSrgb", GL_RGBA8, 0, true, 40},
                      Destination{"SamplesAllAlike", GL_RGBA8, 4, false, 40}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(Blending, EveryBlending, ::testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.name;
  std::erase_if(name, [](char c) { return c == ','; });
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

}  // namespace
}  // namespace understudy::spu::testing
