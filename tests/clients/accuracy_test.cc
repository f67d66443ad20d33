// SPDX-License-Identifier: Apache-2.0
// Accuracy of images: closer to the exact slices than the viewer's own image, the same on any number of ranks,
// and correct with opaque geometry in front of the volume.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/understudy/images/image.h"
#include "tests/clients/command_test.h"
#include "tests/emulation/viewer_frame.h"

namespace clients {
namespace {

using understudy::launcher::read_image;
using understudy::launcher::RgbaImage;

const Words one_view = {"--azimuth", "35", "--elevation", "25", "--background", "0.2", "0.1", "0.3"};

class EveryMode : public CommandTest, public testing::WithParamInterface<const char*> {};

std::vector<double> channels(const viewer_test::Image& image) {
  return {image.rgb.begin(), image.rgb.end()};
}

/// Composites the float frame over the viewer's background; channels 0 to 255.
std::vector<double> over_background(const RgbaImage& frame, const std::vector<double>& background) {
  std::vector<double> result;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const float* pixel = frame.pixel(x, y);
        result.push_back(255 * (double{pixel[channel]} + (1 - double{pixel[3]}) * background[channel]));
      }
  return result;
}

TEST_P(EveryMode, TheImageIsNearerToTheSlicesInDoublePrecisionThanTheViewersOwn) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const std::string mode = GetParam();
  const Words view = one_view + Words{"--no-frame"};
  run_well(
      engine_viewer(mode, view + Words{"--screenshot", file("bare.png"), "--describe", file("bare.json")}));
  const Outcome outcome = run_well(under({"--save-frames", file("frames"), "--report", file("report.json")}) +
                                   engine_viewer(mode, view + Words{"--screenshot", file("under.png")}));
  ASSERT_EQ(substituted(json("report.json")), 1) << outcome.err;

  const nlohmann::json description = json("bare.json");
  const std::vector<double> meant = emulation::emulate(description);
  const auto background = description.at("background").get<std::vector<double>>();
  const double bare = viewer_test::difference(channels(png("bare.png")), meant).rms;
  const double under = viewer_test::difference(channels(png("under.png")), meant).rms;
  const RgbaImage frame = read_image(file("frames") / "frame_0000.pfm");
  ASSERT_TRUE(frame.has_alpha);
  const viewer_test::Difference floats = viewer_test::difference(over_background(frame, background), meant);
  fmt::print(
      "{}, RMS to the {} slices in double precision, of 255: viewer alone {:.4f}, under Understudy {:.4f}, "
      "its float frame {:.4f} (max {:.3f})\n",
      mode, description.at("slices").at("count").get<int>(), bare, under, floats.rms, floats.max);
  EXPECT_LT(floats.rms, bare);
  EXPECT_LE(under, bare);
}

TEST_P(EveryMode, OpaqueGeometryBeforeTheVolumeStaysWhereItWas) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const std::string mode = GetParam();
  run_well(engine_viewer(mode, one_view + Words{"--screenshot", file("bare.png")}));
  run_well(engine_viewer(mode, one_view + Words{"--no-frame", "--screenshot", file("frameless.png")}));
  const Outcome outcome = run_well(under({"--report", file("report.json")}) +
                                   engine_viewer(mode, one_view + Words{"--screenshot", file("under.png")}));
  EXPECT_EQ(substituted(json("report.json")), 1) << outcome.err;
  EXPECT_LT(told(mode + ", what frame and axes change", png("bare.png"), png("frameless.png")).psnr, 35)
      << "there is opaque geometry to be seen";
  EXPECT_GE(told(mode + " with frame and axes, bare and under", png("bare.png"), png("under.png")).psnr, 40);
}

INSTANTIATE_TEST_SUITE_P(Viewer, EveryMode, testing::Values("rgba", "table", "core"),
                         [](const auto& info) { return std::string(info.param); });

class Ranks : public CommandTest {};

constexpr int accuracy_frames = 3;

/// Largest difference of any channel, including alpha, over all frames.
double largest_difference(const std::filesystem::path& a, const std::filesystem::path& b) {
  double largest = 0;
  for (int number = 0; number < accuracy_frames; ++number) {
    const std::string name = fmt::format("frame_{:04}.pfm", number);
    const RgbaImage first = read_image(a / name), second = read_image(b / name);
    if (!first.has_alpha || !second.has_alpha || first.rgba.size() != second.rgba.size()) return HUGE_VAL;
    for (std::size_t i = 0; i < first.rgba.size(); ++i)
      largest = std::max(largest, std::abs(double{first.rgba[i]} - double{second.rgba[i]}));
  }
  return largest;
}

TEST_F(Ranks, AnyNumberOfThemGivesTheSameImages) {
  if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  const Words viewer =
      engine_viewer("core", one_view + Words{"--frames", std::to_string(accuracy_frames), "--orbit", "50"});
  std::vector<int> ranks = {0, 1, 2, 3, 4, 7};
  const auto folder = [&](int count) { return file(fmt::format("frames-{}", count)); };
  for (const int count : ranks) {
    SCOPED_TRACE(fmt::format("{} ranks", count));
    const Outcome outcome = run_well(
        under({"-n", std::to_string(count), "--save-frames", folder(count), "--report", file("report.json")}) +
        viewer);
    const nlohmann::json report = json("report.json");
    ASSERT_EQ(report.at("nodes"), count) << outcome.err;
    ASSERT_EQ(report.at("frames_substituted"), accuracy_frames) << outcome.err;
  }
  const RgbaImage first = read_image(folder(0) / "frame_0000.pfm");
  EXPECT_GT(*std::max_element(first.rgba.begin(), first.rgba.end()), 0.5) << "there is something to see";
  for (std::size_t i = 0; i < ranks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double apart = largest_difference(folder(ranks[i]), folder(ranks[j]));
      fmt::print("{} and {} ranks (0: embedded): at most {:.2e} apart\n", ranks[j], ranks[i], apart);
      EXPECT_LE(apart, 1e-5);
    }
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace clients
