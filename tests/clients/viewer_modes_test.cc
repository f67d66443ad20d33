// SPDX-License-Identifier: Apache-2.0
// The bundled viewer's modes: substituted if the nodes can render the volume, otherwise the viewer's own image,
// bit for bit, with the reason.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "apps/understudy/images/image.h"
#include "tests/clients/command_test.h"

namespace clients {
namespace {

using understudy::launcher::read_image;
using understudy::launcher::RgbaImage;

constexpr int frames = 2;

struct Way {
  const char* name;
  const char* mode;
  Words options;
  int runs;  ///< substituted runs of slices per frame; for bricks, those of the first frame (one run later)
  const char* reason;  ///< why it is refused; null: it is substituted
};

Words view(const Words& options) {
  return Words{"--azimuth", "40",  "--elevation", "30",       "--background",
               "0.9",       "0.8", "0.7",         "--frames", std::to_string(frames),
               "--orbit",   "50"} +
         options;
}

class ViewerModes : public CommandTest, public testing::WithParamInterface<Way> {};

TEST_P(ViewerModes, AreSubstitutedOrLeft) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const Way& way = GetParam();
  const auto viewer = [&](const std::string& images) {
    return engine_viewer(way.mode, view(way.options) + Words{"--screenshot-frames", file(images)});
  };
  run_well(viewer("bare"));
  const Outcome outcome = run_well(under({"--report", file("report.json")}) + viewer("under"));
  const nlohmann::json report = json("report.json");
  const bool merged = std::string_view(way.mode) == "bricks";
  const int runs = merged ? way.runs + frames - 1 : frames * way.runs;
  EXPECT_EQ(substituted(report), way.reason == nullptr ? runs : 0) << outcome.err;
  if (merged) {
    const nlohmann::json& volumes = report.at("volumes");
    ASSERT_EQ(volumes.size(), 1U) << volumes.dump(1);
    const std::string explanation = volumes.at(0).at("explanation");
    EXPECT_TRUE(explanation.starts_with(fmt::format("merged of {} textures: 256x256x110", way.runs)))
        << explanation;
  }
  if (way.reason != nullptr) {
    EXPECT_NE(outcome.err.find(way.reason), std::string::npos) << outcome.err;
  }
  for (int number = 0; number < frames; ++number) {
    const std::string name = fmt::format("frame_{:04}.png", number);
    const auto bare = png("bare/" + name), under_understudy = png("under/" + name);
    if (way.reason != nullptr) {
      EXPECT_EQ(bare.rgb, under_understudy.rgb) << name;
    } else {
      EXPECT_GE(told(fmt::format("{}, {}", way.name, name), bare, under_understudy).psnr, 44);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, ViewerModes,
    testing::Values(Way{"Time", "time", {}, 1, nullptr},
                    Way{"TimeInPart", "time", {"--time-step", "part"}, 1, nullptr},
                    Way{"TimeInPartAgain", "time", {"--time-step", "again"}, 1, nullptr},
                    Way{"Bricks", "bricks", {}, 50, nullptr},
                    Way{"BricksFrontToBack", "bricks", {"--operator", "under"}, 50, nullptr},
                    Way{"Under", "table", {"--operator", "under", "--opaque"}, 1, nullptr},
                    Way{"UnderInOneBatch", "core", {"--operator", "under"}, 1, nullptr},
                    Way{"Maximum", "table", {"--operator", "max", "--opaque"}, 1, nullptr},
                    Way{"MaximumOfColours", "rgba", {"--operator", "max"}, 1, nullptr},
                    Way{"Minimum", "core", {"--operator", "min", "--opaque"}, 1, nullptr},
                    Way{"Sum", "core", {"--operator", "add", "--preset", "sparse", "--opaque"}, 1, nullptr},
                    Way{"Ball", "core", {"--opaque"}, 1, nullptr},
                    Way{"BallInParallel", "table", {"--opaque", "--ortho"}, 1, nullptr},
                    Way{"Two", "table", {"--second", "--opaque"}, 2, nullptr},
                    Way{"TwoFrontToBack", "core", {"--second", "--operator", "under"}, 2, nullptr},
                    Way{"Lit",
                        "lit",
                        {},
                        0,
                        "the fragment shader: colours depend on a second texel of 'volume' at an offset"},
                    Way{"Preintegrated", "preint", {}, 1, nullptr},
                    Way{"PreintegratedFrontToBack", "preint", {"--operator", "under", "--opaque"}, 1, nullptr},
                    Way{"Stacks", "stacks", {}, 1, nullptr},
                    Way{"StacksFrontToBack", "stacks", {"--operator", "under", "--opaque"}, 1, nullptr}),
    [](const auto& info) { return std::string(info.param.name); });

class TimeSteps : public CommandTest, public testing::WithParamInterface<const char*> {};

// The whole volume once; afterwards the blocks of 16^3 texels that a box in its middle touches.
TEST_P(TimeSteps, SendOnlyWhatChanges) {
  if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  constexpr std::uint64_t whole = 256 * 256 * 110, tiles = 64 * 64 * 48;
  for (const char* ranks : {"0", "4"}) {
    const std::string folder = std::string("frames") + ranks;
    const Outcome outcome =
        run_well(under({"-n", ranks, "--save-frames", file(folder), "--report", file("report.json")}) +
                 engine_viewer("time", {"--time-step", GetParam(), "--frames", "3", "--orbit", "20"}));
    const nlohmann::json report = json("report.json");
    ASSERT_EQ(substituted(report), 3) << outcome.err;
    const nlohmann::json& texels = report.at("volumes").at(0).at("texels");
    const auto sent = texels.at("bytes_sent").get<std::uint64_t>();
    fmt::print("{} on {} ranks: {} bytes sent\n", GetParam(), ranks, sent);
    EXPECT_EQ(sent + texels.at("bytes_left_out").get<std::uint64_t>(), 3 * whole);
    EXPECT_GT(sent, whole);
    // Blocks of air do not change.
    EXPECT_LT(sent, std::string(GetParam()) == "whole" ? 3 * whole : whole + 2 * tiles + 1);
  }
  for (int number = 0; number < 3; ++number) {
    const std::string name = fmt::format("frame_{:04}.pfm", number);
    const RgbaImage one = read_image(file("frames0") / name), four = read_image(file("frames4") / name);
    ASSERT_EQ(one.rgba.size(), four.rgba.size());
    float largest = 0;
    for (std::size_t i = 0; i < one.rgba.size(); ++i)
      largest = std::max(largest, std::abs(one.rgba[i] - four.rgba[i]));
    EXPECT_LE(largest, 1e-5F) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, TimeSteps, testing::Values("whole", "part", "again"),
                         [](const auto& info) { return std::string(info.param); });

/// An operator, or the pre-integrated segments.
class OperatorsOnRanks : public CommandTest, public testing::WithParamInterface<const char*> {};

TEST_P(OperatorsOnRanks, GiveTheImageOfOneProcess) {
  if (const std::string lacking = missing({Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  const std::string name = GetParam();
  const Words way = name == "segments" ? Words{"--mode", "preint"} : Words{"--operator", name};
  // No voxel is 0, so that a minimum shows something.
  std::string voxels;
  constexpr int edge = 50;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        voxels.push_back(static_cast<char>(90 + x / 2 + y / 3 + 40 * (z / 10 % 2)));
  const Words viewer = Words{(programs / "understudy-viewer").string(),
                             folder_.write("fog.50x50x50", voxels),
                             "--preset",
                             "dense",
                             "--offscreen",
                             "--window-size",
                             "200",
                             "200"} +
                       view(way + Words{"--opaque"});
  for (const char* ranks : {"0", "2"}) {
    const Outcome outcome = run_well(under({"-n", ranks, "--save-frames", file(std::string("frames") + ranks),
                                            "--report", file("report.json")}) +
                                     viewer);
    ASSERT_EQ(json("report.json").at("frames_substituted"), frames) << outcome.err;
  }
  double largest = 0, brightest = 0;
  for (int number = 0; number < frames; ++number) {
    const std::string frame = fmt::format("frame_{:04}.pfm", number);
    const RgbaImage one = read_image(file("frames0") / frame), two = read_image(file("frames2") / frame);
    ASSERT_EQ(one.rgba.size(), two.rgba.size());
    for (std::size_t i = 0; i < one.rgba.size(); ++i) {
      // Without a sample, a minimum is larger than any colour of a float framebuffer.
      const double a = std::min(one.rgba[i], 1e3F), b = std::min(two.rgba[i], 1e3F);
      largest = std::max(largest, std::abs(a - b));
      if (a < 1e3) brightest = std::max(brightest, a);
    }
  }
  fmt::print("{}: at most {:.2e} apart, largest value {:.2f}\n", name, largest, brightest);
  EXPECT_GT(brightest, 0.3) << "there is something to see";
  EXPECT_LE(largest, 1e-5 * std::max(1.0, brightest));
}

INSTANTIATE_TEST_SUITE_P(Of, OperatorsOnRanks,
                         testing::Values("over", "under", "max", "min", "add", "segments"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace clients
