// SPDX-License-Identifier: Apache-2.0
// Every optimization separately: a viewer with and without it shows the same images, within the optimization's
// tolerance, and the report states what it saved.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/understudy/images/image.h"
#include "spu/report/optimization.h"
#include "tests/clients/command_test.h"

namespace clients {
namespace {

using understudy::launcher::read_image;
using understudy::launcher::RgbaImage;
using understudy::spu::Optimization;
using understudy::spu::optimization_table;
using understudy::spu::OptimizationText;

constexpr int left_out_frames = 4;

struct Case {
  Optimization optimization;
  Words viewer;             ///< arguments for a scene in which work can be skipped
  Words options = {};       ///< of `understudy run`
  std::uint64_t still = 0;  ///< amount that is skipped even when disabled
  const char* mode = "core";
};

/// Colours increase with the value, so that a maximum of colours is one of values.
const char* const rising = R"({"knots": [{"at": 0, "colour": [0, 0, 0], "opacity": 0},
                                         {"at": 1, "colour": [1, 1, 1], "opacity": 1}]})";

const std::array cases{
    Case{Optimization::empty_bricks, {"--orbit", "10"}},
    Case{Optimization::hidden_samples, {"--orbit", "10", "--preset", "step"}},
    Case{Optimization::dominated_samples, {"--orbit", "10", "--operator", "max", "--table", "rising.json"}},
    Case{Optimization::footprints, {"--orbit", "10", "--preset", "sparse"}, {"-n", "3", "--sort", "last"}},
    Case{Optimization::unchanged_images, {}},
    Case{Optimization::unchanged_images, {"--second"}},
    Case{Optimization::unchanged_texels, {"--orbit", "10"}},
    Case{Optimization::known_colours, {"--orbit", "10"}},
    Case{Optimization::absent_depth, {"--orbit", "10"}},
    Case{Optimization::unseen_depth, {"--orbit", "10", "--write-depth"}},
};

double largest_difference(const RgbaImage& a, const RgbaImage& b) {
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  double most = 0;
  for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
    most = std::max(most, std::abs(double(a.rgba[i]) - double(b.rgba[i])));
  return most;
}

class LeftOut : public CommandTest, public testing::WithParamInterface<std::size_t> {
 protected:
  /// Saves float frames, screenshots and the report, with names that begin with `name`.
  nlohmann::json show(const Case& shown, const std::string& name, const Words& options) {
    std::filesystem::create_directories(file(name + "_shown"));
    Words viewer = shown.viewer;
    std::replace(viewer.begin(), viewer.end(), std::string("rising.json"), file("rising.json").string());
    const Words recording = {"--report", file(name + ".json"), "--save-frames", file(name), "--explain"};
    outcome = run_well(
        under(shown.options + options + recording) +
        engine_viewer(shown.mode, viewer + Words{"--no-frame", "--frames", std::to_string(left_out_frames),
                                                 "--screenshot-frames", file(name + "_shown")}));
    nlohmann::json report = json(name + ".json");
    EXPECT_EQ(report.at("frames_substituted"), left_out_frames) << outcome.err;
    return report;
  }

  Outcome outcome;
};

TEST_P(LeftOut, ChangesNoImage) {
  const Case& shown = cases[GetParam()];
  const bool nodes = !shown.options.empty();
  if (const std::string lacking = missing(nodes ? std::initializer_list<Need>{Need::engine, Need::mpi}
                                                : std::initializer_list<Need>{Need::engine});
      !lacking.empty())
    GTEST_SKIP() << lacking;
  std::ofstream(file("rising.json")) << rising;
  const OptimizationText& about = understudy::spu::text_of(shown.optimization);
  const nlohmann::json with = show(shown, "with", {});
  const Outcome told = outcome;
  const nlohmann::json without = show(shown, "without", {"--disable-optimization", about.name});

  const nlohmann::json& item = with.at("left_out").at("items").at(about.name);
  const nlohmann::json& nevertheless = without.at("left_out").at("items").at(about.name);
  const auto left_out = item.at("left_out").get<std::uint64_t>(), done = item.at("done").get<std::uint64_t>(),
             still = nevertheless.at("left_out").get<std::uint64_t>(),
             done_without = nevertheless.at("done").get<std::uint64_t>();
  double most = 0;
  for (int frame = 0; frame < left_out_frames; ++frame) {
    const std::string png = fmt::format("frame_{:04}.png", frame);
    EXPECT_LE(largest_difference(read_image(file("with_shown") / png), read_image(file("without_shown") / png)),
              about.tolerance > 0 ? 1.01 / 255 : 0);
  }
  for (const auto& entry : std::filesystem::directory_iterator(file("with"))) {
    const std::string name = entry.path().filename().string();
    if (name.find("_alpha") == std::string::npos)
      most = std::max(most, largest_difference(read_image(entry.path()), read_image(file("without") / name)));
  }
  fmt::print("{} ({}): {} of {} {} left out, {} without; images differ by {:.1e}, tolerance {:.0e}\n",
             about.name, fmt::join(shown.viewer, " "), left_out, left_out + done, about.unit, still, most,
             about.tolerance);
  EXPECT_LE(most, about.tolerance);
  EXPECT_GT(left_out, 0U);
  EXPECT_EQ(still, 0U);
  EXPECT_GT(done_without, done) << "what is not left out is done";
  EXPECT_NE(told.err.find(fmt::format("{}: left out", about.name)), std::string::npos) << told.err;
}

INSTANTIATE_TEST_SUITE_P(Items, LeftOut, testing::Range(std::size_t(0), cases.size()), [](const auto& info) {
  std::string name = optimization_table()[std::size_t(cases[info.param].optimization)].name;
  std::replace(name.begin(), name.end(), '-', '_');
  return fmt::format("{}_{}", name, info.param);
});

class Explained : public CommandTest {};

TEST_F(Explained, FrameByFrameAndInTheEnd) {
  if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  // For whole windows, `auto` might choose another exchange with fewer messages.
  const Outcome outcome = run_well(under({"-n", "2", "--sort", "last", "--exchange", "direct-send", "--overlap",
                                          "off", "--explain", "--report", file("report.json")}) +
                                   engine_viewer("core", {"--frames", "3", "--orbit", "5", "--no-frame"}));
  for (const char* const said :
       {"frame 1: ", "frame 3: ", "left out: empty-bricks (", "not looked for: ", "the camera moved (2x)",
        "blocks show something", "rays are seen through to their end", "samples reached these pixels"})
    EXPECT_NE(outcome.err.find(said), std::string::npos) << said << "\n" << outcome.err;
  const nlohmann::json report = json("report.json");
  EXPECT_EQ(report.at("left_out").at("items").at("unchanged-images").at("because").at("the camera moved"), 2);
  const nlohmann::json& exchanged = report.at("exchanged");
  EXPECT_GT(exchanged.at("bytes"), 0);
  EXPECT_LT(exchanged.at("bytes"), exchanged.at("bytes_of_whole_windows"));
  EXPECT_LE(exchanged.at("messages"), exchanged.at("messages_of_whole_windows"));
  EXPECT_GT(report.at("frames_detail").at(1).at("left_out").at("items").at("empty-bricks"), 0);
  fmt::print("{}", outcome.err);
}

TEST_F(Explained, NamesOfItemsAreChecked) {
  const Outcome refused = run(under({"--disable-optimization", "pixels"}) + Words{"true"});
  EXPECT_EQ(refused.status, 2);
  for (const OptimizationText& about : optimization_table())
    EXPECT_NE(refused.err.find(about.name), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace clients
