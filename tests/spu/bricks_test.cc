// SPDX-License-Identifier: Apache-2.0
// A volume in many textures, above a real driver: from the second frame on it is one volume with the same
// image.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bricked_cube.h"
#include "colour_target.h"
#include "compositor/service.h"
#include "drawing.h"
#include "spu/report/counters.h"
#include "spu/volume/session/render_session.h"

namespace understudy::spu::testing {
namespace {

constexpr int edge = 12;  ///< 3 x 2 x 2 bricks of the blob

class Bricks : public ::testing::Test {
 protected:
  void SetUp() override {
    app = GlApplication::start(Profile::compatibility, options());
    if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    cube = std::make_unique<BrickedCube>(*app, edge, kind());
    target = std::make_unique<ColourTarget>(*app, GL_RGBA32F);
    ASSERT_TRUE(target->complete());
  }

  virtual BrickKind kind() const { return {}; }
  virtual Options options() const { return {}; }

  std::vector<float> frame(bool under, const BrickedCube::Drawing& drawing) {
    app->use_chain(under);
    target->clear(kind().background);
    app->gl().DepthMask(GL_TRUE);
    app->gl().Clear(GL_DEPTH_BUFFER_BIT);
    if (before) before();
    cube->draw(*app, drawing);
    app->end_frame();
    return target->read();
  }
  std::vector<float> frame(bool under, double angle = 15) { return frame(under, at(angle)); }

  static BrickedCube::Drawing at(double angle) {
    BrickedCube::Drawing drawing;
    drawing.angle = angle;
    return drawing;
  }

  /// Draws one frame, expects it to look like the application's own, and returns the number of runs substituted
  /// in it.
  std::uint64_t substituted_in(const BrickedCube::Drawing& drawing) {
    const std::uint64_t runs = app->substituted();
    const auto under = frame(true, drawing);
    const std::uint64_t more = app->substituted() - runs;
    const auto bare = frame(false, drawing);
    EXPECT_GT(*std::max_element(bare.begin(), bare.end()), 0.4F) << "there is something to see";
    EXPECT_GE(psnr(under, bare), kind().least_psnr) << drawing.angle << " degrees, " << more << " runs";
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
    return more;
  }
  std::uint64_t substituted_in(double angle = 15) { return substituted_in(at(angle)); }

  void expect_merged() { EXPECT_EQ(substituted_in(), 1U) << app->last_reason(); }

  std::unique_ptr<GlApplication> app;
  std::unique_ptr<BrickedCube> cube;
  std::unique_ptr<ColourTarget> target;
  std::function<void()> before;
};

TEST_F(Bricks, AreOneVolumeFromTheSecondFrameOn) {
  const auto apart = frame(true);
  EXPECT_EQ(app->substituted(), cube->bricks()) << app->last_reason();
  EXPECT_EQ(app->left(), 0U);
  const auto merged = frame(true);
  EXPECT_EQ(app->substituted(), cube->bricks() + 1);
  float largest = 0;
  for (std::size_t i = 0; i < merged.size(); ++i) largest = std::max(largest, std::abs(merged[i] - apart[i]));
  std::printf("merged against brick by brick: %g at most\n", double(largest));
  EXPECT_LE(largest, 2e-5F) << "the same samples in the same order";
  for (const double angle : {-40.0, 0.0, 35.0}) EXPECT_EQ(substituted_in(angle), 1U) << angle;
  EXPECT_EQ(app->left(), 0U);
}

TEST_F(Bricks, AreSaidToBeMerged) {
  frame(true);
  frame(true);
  const ProcessCounters& counters = process_counters();
  const std::string wanted = "merged of " + std::to_string(cube->bricks()) + " textures: 24x20x17 RGBA texels";
  const bool told =
      std::any_of(std::begin(counters.volume), std::end(counters.volume), [&](const VolumeCounters& volume) {
        return volume.place != VolumePlace::given_up && std::string(volume.explanation).starts_with(wanted);
      });
  EXPECT_TRUE(told) << wanted;
}

TEST_F(Bricks, AreMergedWhereBlendingStaysSwitchedOn) {
  auto drawing = at(15);
  drawing.blending_stays = true;
  EXPECT_EQ(substituted_in(drawing), cube->bricks());
  EXPECT_EQ(substituted_in(drawing), 1U);
}

TEST_F(Bricks, OfWhichOneChangesSendThatOne) {
  frame(true);
  expect_merged();
  const std::uint64_t sent = app->texel_bytes_sent();
  app->use_chain(true);
  const auto before_change = frame(true);
  cube->repaint(*app, 0);
  const auto changed = frame(true);
  EXPECT_LT(psnr(before_change, changed), 40) << "the new colours change nothing: the test tests nothing";
  expect_merged();
  // Blocks of 16 texels, of which the brick touches one.
  EXPECT_LE(app->texel_bytes_sent() - sent, 4U * 16 * 16 * 16);
  EXPECT_GT(app->texel_bytes_sent(), sent);
}

TEST_F(Bricks, OfWhichOneIsNotDrawnAreShownOneByOne) {
  frame(true);
  expect_merged();
  auto drawing = at(15);
  drawing.without = {cube->bricks() - 1};
  EXPECT_EQ(substituted_in(drawing), cube->bricks() - 1);
  expect_merged();
}

TEST_F(Bricks, WithGeometryBetweenThemAreShownOneByOne) {
  frame(true);
  expect_merged();
  auto drawing = at(15);
  drawing.before_brick = [&](std::size_t number) {
    if (number == 4) draw_square(*app, 0.5, 0, {0.9F, 0.8F, 0.1F, 1});
  };
  EXPECT_EQ(substituted_in(drawing), cube->bricks());
  expect_merged();
}

TEST_F(Bricks, AreHiddenByWhatStandsBeforeThem) {
  app->gl().DepthFunc(GL_LESS);
  before = [&] {
    app->gl().Enable(GL_DEPTH_TEST);
    look(*app, View::perspective, 15);
    draw_square(*app, 0.5, 0.1, {0.9F, 0.8F, 0.1F, 1});
    app->gl().DepthMask(GL_FALSE);
  };
  EXPECT_EQ(substituted_in(), cube->bricks()) << app->last_reason();
  expect_merged();
  app->gl().Disable(GL_DEPTH_TEST);
}

TEST_F(Bricks, AreThereForWhoReadsPixels) {
  frame(true);
  expect_merged();
  std::vector<float> read_under;
  std::vector<float> read_bare;
  auto drawing = at(15);
  for (const bool under : {true, false}) {
    drawing.before_brick = [&](std::size_t number) {
      if (number == 5) (under ? read_under : read_bare) = app->read_pixels();
    };
    frame(under, drawing);
  }
  EXPECT_GE(psnr(read_under, read_bare), 55);
  EXPECT_LT(psnr(read_bare, frame(false)), 50) << "the last bricks change nothing: the test tests nothing";
  expect_merged();
}

TEST_F(Bricks, BehindAScissorThatMovesAreShownOneByOne) {
  frame(true);
  expect_merged();
  auto drawing = at(15);
  drawing.before_brick = [&](std::size_t number) {
    if (number != 6) return;
    app->gl().Enable(GL_SCISSOR_TEST);
    app->gl().Scissor(0, 0, GlApplication::size / 2, GlApplication::size);
  };
  const auto shown = [&](bool under) {
    auto pixels = frame(under, drawing);
    app->gl().Disable(GL_SCISSOR_TEST);
    return pixels;
  };
  EXPECT_GE(psnr(shown(true), shown(false)), 55);
  expect_merged();
}

TEST_F(Bricks, DrawnInTheWrongOrderAreShownInThatOrder) {
  auto drawing = at(15);
  drawing.wrong_order = true;
  EXPECT_EQ(substituted_in(drawing), cube->bricks());
  EXPECT_EQ(substituted_in(drawing), cube->bricks());
  EXPECT_EQ(substituted_in(drawing), cube->bricks());
}

TEST_F(Bricks, OfOtherColoursAreNotMerged) {
  app->gl().TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
  auto drawing = at(15);
  drawing.before_brick = [&](std::size_t number) {
    const auto red = number == 3 ? 0.2F : 1.0F;
    app->gl().Color4f(red, 1, 1, 1);
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(substituted_in(drawing), cube->bricks());
}

TEST_F(Bricks, ThatWaitWhenTheNodesAreLostAreShownAllTheSame) {
  frame(true);
  expect_merged();
  auto drawing = at(15);
  bool lost = false;
  drawing.before_brick = [&](std::size_t number) {
    if (number != 5 || lost) return;
    lost = true;
    const auto lock = app->session().lock();
    app->session().lost(compositor::ServiceLost("the test has taken the nodes away"));
  };
  EXPECT_GE(substituted_in(drawing), 5U) << "the bricks that waited";
  EXPECT_GE(app->left(), 1U) << "bricks that came later";
  // After a while another service is requested and receives the volume again.
  std::uint64_t runs = 0;
  for (int i = 0; i < 10000 && runs != 1; ++i) runs = substituted_in();
  EXPECT_EQ(runs, 1U);
}

/// Compared tiles and frames of all volumes so far.
struct Comparisons {
  std::uint64_t tiles = 0;
  std::uint64_t frames = 0;
  std::uint64_t lost = 0;

  static Comparisons so_far() {
    Comparisons sum;
    for (const VolumeCounters& volume : process_counters().volume) {
      sum.tiles += volume.verified_tiles;
      sum.frames += volume.verified_frames;
      sum.lost += volume.verify_lost;
    }
    return sum;
  }
};

TEST_F(Bricks, HaveSentinelsAsOneVolume) {
  frame(true);
  expect_merged();
  const Comparisons before_turning = Comparisons::so_far();
  for (int i = 0; i < 20; ++i) EXPECT_EQ(substituted_in(15 + i), 1U) << i;
  const Comparisons after = Comparisons::so_far();
  EXPECT_GT(after.tiles, before_turning.tiles);
  EXPECT_EQ(after.frames, before_turning.frames) << "nothing changed but the camera";
  EXPECT_EQ(after.lost, before_turning.lost);
}

class BricksComparedInEveryFrame : public Bricks {
  /// The image's own alpha is what the framebuffer's alpha becomes.
  BrickKind kind() const override {
    return {.blending = [](const DispatchTable& gl) {
      gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    }};
  }
  Options options() const override { return {.verify = 1}; }
};

TEST_F(BricksComparedInEveryFrame, AreShownAsTheApplicationDrawsThemWhereTheirImageIsWrong) {
  frame(true);
  expect_merged();
  const Comparisons before_change = Comparisons::so_far();
  app->use_chain(false);
  cube->repaint(*app, 0);
  EXPECT_EQ(substituted_in(), 0U) << "the nodes have the texels of before";
  EXPECT_EQ(app->left(), cube->bricks());
  EXPECT_EQ(Comparisons::so_far().lost, before_change.lost + 1);
}

TEST_F(Bricks, ThatAreDeletedTakeTheVolumeWithThem) {
  frame(true);
  expect_merged();
  const GLuint texture = cube->texture(0);
  app->use_chain(true);
  app->gl().DeleteTextures(1, &texture);
  auto drawing = at(15);
  drawing.without = {0};
  for (int i = 0; i < 3; ++i) EXPECT_GE(substituted_in(drawing), 1U);
}

/// For a maximum or minimum, one stray sample beyond a slice's edge can be the result
/// (strayed_samples_test.cc).
constexpr double strayed_samples_psnr = 45;

class KindsOfBricks : public Bricks, public ::testing::WithParamInterface<BrickKind> {
  BrickKind kind() const override { return GetParam(); }
};

TEST_P(KindsOfBricks, AreOneVolume) {
  frame(true);
  EXPECT_EQ(app->substituted(), cube->bricks()) << app->last_reason();
  for (const double angle : {15.0, -40.0, 35.0}) EXPECT_EQ(substituted_in(angle), 1U) << angle;
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
}

std::vector<BrickKind> kinds_of_bricks() {
  const auto equation = [](GLenum name) { return [name](const DispatchTable& gl) { gl.BlendEquation(name); }; };
  const char* const thin = "vec4(s, 1.0 - s, 0.35, 0.2 * s * s)";
  return {{.name = "Bytes", .internal_format = GL_INTENSITY8},
          {.name = "Words", .internal_format = GL_INTENSITY16},
          {.name = "ColoursUnderGlsl", .colour = "texel"},
          {.name = "WordsUnderGlsl", .internal_format = GL_R16, .colour = thin},
          {.name = "FloatsUnderGlsl", .internal_format = GL_R32F, .colour = thin},
          {.name = "Maximum",
           .internal_format = GL_R8,
           .colour = "vec4(s)",
           .blending = equation(GL_MAX),
           .least_psnr = strayed_samples_psnr},
          {.name = "Minimum",
           .internal_format = GL_R8,
           .colour = "vec4(1.0 - s)",
           .blending = equation(GL_MIN),
           .background = {1, 1, 1, 1},
           .least_psnr = strayed_samples_psnr},
          {.name = "Sum",
           .internal_format = GL_R8,
           .colour = thin,
           .blending = [](const DispatchTable& gl) { gl.BlendFunc(GL_SRC_ALPHA, GL_ONE); }},
          {.name = "Under",
           .internal_format = GL_R8,
           .colour = "vec4(0.2 * s * s * vec3(s, 1.0 - s, 0.35), 0.2 * s * s)",
           .blending = [](const DispatchTable& gl) { gl.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE); },
           .front_to_back = true,
           .background = {}}};
}

INSTANTIATE_TEST_SUITE_P(Of, KindsOfBricks, ::testing::ValuesIn(kinds_of_bricks()),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace understudy::spu::testing
