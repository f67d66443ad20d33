// SPDX-License-Identifier: Apache-2.0
// Slices under every blending that the nodes support, in framebuffers of several formats, compared with the
// same slices in double precision. Every channel has its own bound (`tests/emulation/precision.h`).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "colour_target.h"
#include "emulated_scenes.h"
#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

/// How slices blend, for the driver and for the emulation.
struct Blend : SliceBlending {
  emulation::Blending meant;
};

struct Case {
  const char* name;
  Blend blending;
  std::array<float, 4> background{0.1F, 0.2F, 0.3F, 0.0F};
};

emulation::Factor factor(GLenum name) {
  switch (name) {
    case GL_ONE:
      return emulation::Factor::one;
    case GL_SRC_ALPHA:
      return emulation::Factor::source_alpha;
    case GL_ONE_MINUS_SRC_ALPHA:
      return emulation::Factor::one_minus_source_alpha;
    case GL_DST_ALPHA:
      return emulation::Factor::destination_alpha;
    case GL_ONE_MINUS_DST_ALPHA:
      return emulation::Factor::one_minus_destination_alpha;
    default:
      return emulation::Factor::zero;
  }
}

emulation::Equation equation(GLenum name) {
  return name == GL_MAX   ? emulation::Equation::max
         : name == GL_MIN ? emulation::Equation::min
                          : emulation::Equation::add;
}

struct Function {
  GLenum equation = GL_FUNC_ADD;
  GLenum source = GL_ONE;
  GLenum destination = GL_ONE;

  emulation::BlendFunction meant() const {
    return {testing::equation(equation), factor(source), factor(destination)};
  }
};

Blend separate(const Function& colour, const Function& alpha, bool front_to_back = false) {
  return {{[=](const DispatchTable& gl) {
             gl.BlendEquationSeparate(colour.equation, alpha.equation);
             gl.BlendFuncSeparate(colour.source, colour.destination, alpha.source, alpha.destination);
           },
           front_to_back},
          {colour.meant(), alpha.meant()}};
}

Blend factors(GLenum colour_source, GLenum colour_destination, GLenum alpha_source, GLenum alpha_destination,
              bool front_to_back = false) {
  return separate({GL_FUNC_ADD, colour_source, colour_destination},
                  {GL_FUNC_ADD, alpha_source, alpha_destination}, front_to_back);
}

Blend equations(GLenum colour, GLenum alpha) {
  return separate({colour}, {alpha});
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
      {"over, greatest alpha", separate({GL_FUNC_ADD, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA},
                                        {GL_MAX, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA})},
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
  emulation::Rounding rounding;
  int alpha_bits;
};

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {{"RGBA32F", GL_RGBA32F, emulation::floating(23), 32},
                                          {"RGBA16F", GL_RGBA16F, emulation::floating(10), 16},
                                          {"RGBA16", GL_RGBA16, emulation::normalised(16, 16), 16},
                                          {"RGBA8", GL_RGBA8, emulation::normalised(8, 8), 8}};
  return all;
}

/// Error bound of one image of all slices in a framebuffer of the format: it is blended once. Separate alpha is
/// rendered in a request of its own and blended in two steps.
emulation::Rounding once(const Format& format) {
  emulation::Rounding rounding = emulation::presented(format.rounding);
  rounding.alpha_result *= 2;
  if (format.alpha_bits <= 8) rounding.alpha_result += emulation::alpha_termination;
  // The image itself: two roundings per slice.
  rounding.relative += 2 * 40 * emulation::float_step;
  return rounding;
}

class EveryBlending : public ::testing::TestWithParam<Case> {
 protected:
  /// Draws one frame of the scene into a framebuffer of the format, with or without the chain.
  static std::vector<float> frame(GlApplication& app, const ColourTarget& target, const SliceScene& scene,
                                  bool under) {
    app.use_chain(under);
    target.clear(GetParam().background);
    scene.slices_and_tidy_up(app, 25);
    app.end_frame();
    return target.read();
  }

  static emulation::Frame meant(bool colours) {
    const Case& way = GetParam();
    const bool front_to_back = way.blending.front_to_back;
    const auto& [r, g, b, a] = way.background;
    return frame_of({colours ? colour_cube(blob_colours(), 25, front_to_back)
                             : table_cube(blob_values(), 25, front_to_back)},
                    {r, g, b, a}, way.blending.meant);
  }
};

TEST_P(EveryBlending, LiesWithinItsArithmeticsBoundsInEveryColourFormat) {
  for (const bool colours : {false, true}) {
    const emulation::Frame exact = meant(colours);
    for (const Format& format : formats()) {
      auto app = GlApplication::start(Profile::compatibility);
      if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
      const SliceScene scene =
          colours ? immediate_rgba(GetParam().blending) : client_arrays_table(GetParam().blending);
      scene.set_up(*app);
      const ColourTarget target(*app, format.internal_format);
      ASSERT_TRUE(target.complete()) << format.name;
      const std::string what =
          fmt::format("{}, {}, {}", GetParam().name, colours ? "colours" : "table", format.name);
      const auto bare = frame(*app, target, scene, false);
      expect_within(
          (what + ", driver").c_str(),
          emulation::draw(exact, emulation::drivers, format.rounding, {.clamps = format.rounding.clamps}),
          bare);
      const auto under = frame(*app, target, scene, true);
      EXPECT_EQ(app->substituted(), 1U) << format.name << ": " << app->last_reason();
      const emulation::Image shown =
          emulation::draw(exact, emulation::ours, {.clamps = format.rounding.clamps}, once(format));
      expect_within(what.c_str(), shown, under);
      EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
      // The bounds must be able to detect a missing volume.
      app->use_chain(false);
      target.clear(GetParam().background);
      EXPECT_GT(channels_outside(shown, target.read()), 500) << "there is nothing to be seen";
    }
  }
}

/// Refused: blending does not suit the destination's format, or it is unknown whether it does.
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
  Format format;
  int channels;
  int samples = 0;
  bool srgb = false;  ///< GL_FRAMEBUFFER_SRGB
};

class Destinations : public ::testing::TestWithParam<Destination> {};

/// Linear intensity of a colour stored as sRGB (IEC 61966-2-1).
float intensity(float stored) {
  return stored <= 0.04045F ? stored / 12.92F : std::pow((stored + 0.055F) / 1.055F, 2.4F);
}

TEST_P(Destinations, ShowTheImageWithinTheirBounds) {
  const Destination& destination = GetParam();
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  const ColourTarget target(*app, destination.format.internal_format, destination.samples);
  if (!target.complete()) GTEST_SKIP() << "the driver does not draw into this format";
  const bool intensities = destination.srgb && destination.format.internal_format == GL_SRGB8_ALPHA8;
  const auto frame = [&](bool under, bool volume) {
    app->use_chain(under);
    app->gl().Disable(GL_MULTISAMPLE);
    if (destination.srgb) app->gl().Enable(GL_FRAMEBUFFER_SRGB);
    target.clear({0.1F, 0.2F, 0.3F, 0.4F});
    if (volume) scene.slices_and_tidy_up(*app, 25);
    app->end_frame();
    std::vector<float> pixels = target.read();
    for (std::size_t i = 0; intensities && i < pixels.size(); ++i)
      if (i % 4 != 3) pixels[i] = intensity(pixels[i]);
    return pixels;
  };
  const auto under = frame(true, true);
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  const emulation::Image shown =
      emulation::draw(frame_of({table_cube(blob_values(), 25)}, {0.1F, 0.2F, 0.3F, 0.4F}), emulation::ours,
                      {.clamps = destination.format.rounding.clamps}, once(destination.format));
  expect_within(destination.format.name, shown, under, destination.channels);
  EXPECT_GT(channels_outside(shown, frame(false, false), destination.channels), 500)
      << "there is nothing to be seen";
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

std::vector<Destination> destinations() {
  const emulation::Rounding bytes = emulation::normalised(8, 8);
  // The slope of intensity() is greatest at 1: 2.4 / 1.055.
  emulation::Rounding intensities = bytes;
  for (double* error : {&intensities.source, &intensities.result}) *error *= 2.4 / 1.055;
  return {{{"RGBA8", GL_RGBA8, bytes, 8}, 4},
          {{"RGB8", GL_RGB8, bytes, 0}, 3},
          {{"RGB10_A2", GL_RGB10_A2, emulation::normalised(10, 2), 2}, 4},
          // Blue has the shortest mantissa: five bits.
          {{"R11F_G11F_B10F", GL_R11F_G11F_B10F, emulation::floating(5), 0}, 3},
          {{"R8", GL_R8, bytes, 0}, 1},
          {{"RG16F", GL_RG16F, emulation::floating(10), 0}, 2},
          {{"SrgbConverted", GL_SRGB8_ALPHA8, intensities, 8}, 4, 0, true},
          {{"SrgbAsItIs", GL_SRGB8_ALPHA8, bytes, 8}, 4},
          {{"LinearUnderSrgb", GL_RGBA8, bytes, 8}, 4, 0, true},
          {{"SamplesAllAlike", GL_RGBA8, bytes, 8}, 4, 4}};
}

INSTANTIATE_TEST_SUITE_P(Blending, Destinations, ::testing::ValuesIn(destinations()),
                         [](const auto& info) { return std::string(info.param.format.name); });

INSTANTIATE_TEST_SUITE_P(Blending, EveryBlending, ::testing::ValuesIn(cases()), [](const auto& info) {
  std::string name = info.param.name;
  std::erase_if(name, [](char c) { return c == ','; });
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

}  // namespace
}  // namespace understudy::spu::testing
