// SPDX-License-Identifier: Apache-2.0
// While the camera moves, the images of a view are one frame late and never those of another view; when it
// rests, the correct image follows in every view.
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/command_test.h"

namespace clients {
namespace {

constexpr std::size_t view_bytes = std::size_t{3} * 256 * 256;
/// Each of them turns for so many frames.
constexpr std::size_t turns = 12;

using Frames = std::vector<std::string>;

class Pipeline : public CommandTest {
 protected:
  struct Shown {
    std::string turning, resting;
    std::array<Frames, 2> views;  ///< what each view shows, frame by frame
    nlohmann::json report;
    std::string said;
  };

  Shown turn_and_rest(const std::string& name, const Words& prefix, const Words& views = {},
                      std::size_t frames = turns) {
    const auto display = viewer_test::VirtualDisplay::start();
    EXPECT_TRUE(display) << "Xvfb does not start";
    const Outcome outcome =
        run_well(prefix + Words{TURNS_AND_RESTS, file(name), std::to_string(frames)} + views,
                 {{"DISPLAY", display ? display->name() : ""}});
    Shown shown{contents(file(name + ".turning")), contents(file(name)), {}, {}, outcome.out};
    for (std::size_t view = 0; view < shown.views.size(); ++view)
      shown.views[view] = frames_of(file(name + ".view" + std::to_string(view)));
    // Of the second thread.
    shown.resting += contents(file(name + ".other"));
    if (shown.views[1].empty()) shown.views[1] = frames_of(file(name + ".other.view0"));
    return shown;
  }
  Shown turn_and_rest_under(const std::string& name, const Words& options, const Words& views = {},
                            std::size_t frames = turns) {
    Shown shown = turn_and_rest(name, under(options + Words{"--report", file(name + ".json")}), views, frames);
    shown.report = json(name + ".json");
    return shown;
  }

  static Frames frames_of(const std::filesystem::path& file) {
    Frames frames;
    const std::string all = contents(file);
    for (std::size_t at = 0; at + view_bytes <= all.size(); at += view_bytes)
      frames.push_back(all.substr(at, view_bytes));
    return frames;
  }

  static viewer_test::Difference difference_between(const std::string& a, const std::string& b) {
    const auto values = [](const std::string& bytes) {
      std::vector<double> channels;
      channels.reserve(bytes.size());
      for (const char byte : bytes) channels.push_back(static_cast<unsigned char>(byte));
      return channels;
    };
    return viewer_test::difference(values(a), values(b));
  }

  /// Expects of every frame of every view that it shows the camera of this frame, or, if `late`, of the frame
  /// before. `punctual` has the images without frame latency, `bare` those of the viewer itself.
  static void expect_own_images(const Shown& shown, const Shown& punctual, const Shown& bare, bool late) {
    for (std::size_t view = 0; view < shown.views.size(); ++view) {
      const Frames& frames = shown.views[view];
      const Frames& right = punctual.views[view];
      const Frames& own = bare.views[view];
      ASSERT_GE(frames.size(), right.empty() ? 0 : turns);
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const std::size_t now = std::min(k, turns - 1);
        const std::size_t before = now - (now > 0 && k < turns ? 1 : 0);
        const bool is_now = frames[k] == right[now] || frames[k] == own[now];
        const bool is_before = frames[k] == right[before] || frames[k] == own[before];
        EXPECT_TRUE(is_now || (late && is_before)) << "view " << view << ", frame " << k;
        const double psnr = std::max(difference_between(frames[k], own[now]).psnr,
                                     late ? difference_between(frames[k], own[before]).psnr : 0);
        EXPECT_GE(psnr, 35) << "beside the viewer's own image; view " << view << ", frame " << k;
      }
      for (std::size_t k = 1; k < right.size() && k < turns; ++k) EXPECT_TRUE(right[k] != right[k - 1]);
    }
  }
};

TEST_F(Pipeline, ShowsTheFrameBeforeWhileTheCameraMovesAndTheRightOneOnceItRests) {
  if (const std::string lacking = missing({Need::mpi, Need::x_server}); !lacking.empty())
    GTEST_SKIP() << lacking;
  const Shown usual = turn_and_rest_under("usual", {"-n", "2"});
  EXPECT_EQ(usual.report.at("frames_substituted"), turns);
  EXPECT_EQ(usual.report.at("images_behind"), 0);
  EXPECT_EQ(usual.report.at("windows_asked"), 0);
  ASSERT_EQ(usual.resting.size(), view_bytes);
  EXPECT_EQ(usual.turning, usual.resting);

  const Shown behind = turn_and_rest_under("behind", {"-n", "2", "--frame-latency", "1", "--verify=-1"});
  EXPECT_GT(behind.report.at("images_behind"), 6);
  EXPECT_GE(behind.report.at("windows_asked"), 1);
  EXPECT_NE(behind.said.find("drawn again 1 times"), std::string::npos) << behind.said;
  EXPECT_NE(behind.turning, usual.turning) << "the frame before";
  EXPECT_EQ(behind.resting, usual.resting);
}

TEST_F(Pipeline, IsOfNoUseWithoutNodes) {
  if (const std::string lacking = missing({Need::x_server}); !lacking.empty()) GTEST_SKIP() << lacking;
  const Shown embedded = turn_and_rest_under("embedded", {"--frame-latency", "1"});
  EXPECT_EQ(embedded.report.at("images_behind"), 0);
  EXPECT_EQ(embedded.turning, embedded.resting);
}

TEST_F(Pipeline, ComparesNoLateImageWithWhatTheViewerDrawsNow) {
  if (const std::string lacking = missing({Need::mpi, Need::x_server}); !lacking.empty())
    GTEST_SKIP() << lacking;
  // Long enough for sentinels.
  const Shown shown =
      turn_and_rest_under("late", {"-n", "2", "--speed-guard", "off", "--frame-latency", "1"}, {}, 200);
  EXPECT_GT(shown.report.at("images_behind"), 0);
  for (const auto& volume : shown.report.at("volumes")) EXPECT_EQ(volume.at("verify").at("lost"), 0);
}

/// How the volume is shown, and how many of its images are late.
struct Views {
  enum class Late { none, any_number, some };
  std::string name;
  Late late;
  Words options{};
};

class PipelineOfViews : public Pipeline, public testing::WithParamInterface<Views> {};

TEST_P(PipelineOfViews, ShowsEveryViewItsOwnImagesAndTheRightOnesOnceItRests) {
  if (const std::string lacking = missing({Need::mpi, Need::x_server}); !lacking.empty())
    GTEST_SKIP() << lacking;
  const auto& [name, late, options] = GetParam();
  const Words nodes = Words{"-n", "2", "--speed-guard", "off"} + options;
  const Shown bare = turn_and_rest("bare", {}, {name});
  const Shown punctual = turn_and_rest_under("punctual", nodes, {name});
  const Shown shown = turn_and_rest_under("late", nodes + Words{"--frame-latency", "1"}, {name});
  EXPECT_GE(punctual.report.at("frames_substituted"), turns);
  expect_own_images(shown, punctual, bare, late != Views::Late::none);
  EXPECT_TRUE(shown.resting == punctual.resting) << "at rest";
  const auto behind = shown.report.at("images_behind").get<int>();
  EXPECT_TRUE(late == Views::Late::any_number || (behind > 0) == (late == Views::Late::some)) << behind;
  for (const auto& volume : shown.report.at("volumes")) EXPECT_EQ(volume.at("verify").at("lost"), 0);
}

// Comparisons draw all colours, so they fail where a colour mask lets an anaglyph's eye write only some.
INSTANTIATE_TEST_SUITE_P(
    All, PipelineOfViews,
    testing::Values(Views{"one", Views::Late::some}, Views{"viewports", Views::Late::some},
                    Views{"windows", Views::Late::some}, Views{"threads", Views::Late::some},
                    Views{"eyes", Views::Late::some, {"--verify=-1"}}, Views{"in_turn", Views::Late::none},
                    Views{"hidden", Views::Late::none}, Views{"followed", Views::Late::any_number}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace clients
