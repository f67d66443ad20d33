// SPDX-License-Identifier: Apache-2.0
// If nothing is recognised, a viewer's calls reach the driver unchanged: the same calls in the same order, with
// the same arguments, and no others. Recorded by apitrace without Understudy, and below a chain that consists
// of the track unit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/osgvolume_command.h"
#include "tests/clients/recording.h"
#include "tests/clients/recording_test.h"

namespace clients {
namespace {

class SameCalls : public RecordingTest {
 protected:
  void expect_same(const RecordedLibrary& library, const Words& viewer, Environment environment) const {
    const std::vector<std::string> bare = calls_in(dump_of_bare(library, viewer, environment));
    environment["UNDERSTUDY_CHAIN"] = "track driver";
    const std::vector<std::string> below = calls_in(dump_of_driver(library, {}, viewer, environment));
    fmt::print("{} calls alone, {} at the driver\n", bare.size(), below.size());
    ASSERT_GT(bare.size(), 100U) << "a recording of nothing agrees with everything";
    EXPECT_GT(json("report.json").at("processes").at(0).at("calls"), 100) << "it did not run under Understudy";
    const auto [alone, driver] = std::mismatch(bare.begin(), bare.end(), below.begin(), below.end());
    EXPECT_TRUE(alone == bare.end() && driver == below.end())
        << "they part at call " << alone - bare.begin()
        << "\nalone:         " << (alone == bare.end() ? "(the end)" : *alone)
        << "\nat the driver: " << (driver == below.end() ? "(the end)" : *driver);
  }
};

class SameCallsOfTheBundledViewer : public SameCalls, public testing::WithParamInterface<const char*> {};

TEST_P(SameCallsOfTheBundledViewer, ReachTheDriver) {
  if (const std::string lacking = missing({Need::engine, Need::apitrace, Need::x_server}); !lacking.empty())
    GTEST_SKIP() << lacking;
  const auto display = viewer_test::VirtualDisplay::start();
  ASSERT_TRUE(display) << "Xvfb does not start";
  // In a window: off screen, the viewer looks up functions in a way that bypasses apitrace's EGL library.
  Words viewer = engine_viewer(GetParam(), {"--frames", "3", "--orbit", "5"});
  std::erase(viewer, "--offscreen");
  expect_same(glx, viewer, {{"DISPLAY", display->name()}});
}

INSTANTIATE_TEST_SUITE_P(Mode, SameCallsOfTheBundledViewer, testing::Values("rgba", "table", "core"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(SameCalls, OfOsgvolumeReachTheDriver) {
  const std::string lacking = missing({Need::engine, Need::apitrace, Need::x_server, Need::osgvolume});
  if (!lacking.empty()) GTEST_SKIP() << lacking;
  const auto display = viewer_test::VirtualDisplay::start();
  ASSERT_TRUE(display) << "Xvfb does not start";
  auto environment = osgvolume_environment(display->name());
  environment["OSG_RUN_FRAME_COUNT"] = "3";
  expect_same(glx, osgvolume(), environment);
}

}  // namespace
}  // namespace clients
