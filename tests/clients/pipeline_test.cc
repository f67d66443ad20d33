// SPDX-License-Identifier: Apache-2.0
// While the camera moves, images are one frame late; when it rests, the correct image follows.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/command_test.h"

namespace clients {
namespace {

class Pipeline : public CommandTest {
 protected:
  struct Shown {
    std::string turning, resting;
    nlohmann::json report;
    std::string said;
  };

  Shown turn_and_rest(const std::string& name, const Words& options) {
    const auto display = viewer_test::VirtualDisplay::start();
    EXPECT_TRUE(display) << "Xvfb does not start";
    const Outcome outcome = run_well(
        under(options + Words{"--report", file(name + ".json")}) + Words{TURNS_AND_RESTS, file(name), "12"},
        {{"DISPLAY", display ? display->name() : ""}});
    return {contents(file(name + ".turning")), contents(file(name)), json(name + ".json"), outcome.out};
  }
};

TEST_F(Pipeline, ShowsTheFrameBeforeWhileTheCameraMovesAndTheRightOneOnceItRests) {
  if (const std::string lacking = missing({Need::mpi, Need::x_server}); !lacking.empty())
    GTEST_SKIP() << lacking;
  const Shown usual = turn_and_rest("usual", {"-n", "2"});
  EXPECT_EQ(usual.report.at("frames_substituted"), 12);
  EXPECT_EQ(usual.report.at("images_behind"), 0);
  EXPECT_EQ(usual.report.at("windows_asked"), 0);
  ASSERT_EQ(usual.resting.size(), 3U * 256 * 256);
  EXPECT_EQ(usual.turning, usual.resting);

  const Shown behind = turn_and_rest("behind", {"-n", "2", "--frame-latency", "1"});
  EXPECT_GT(behind.report.at("images_behind"), 6);
  EXPECT_GE(behind.report.at("windows_asked"), 1);
  EXPECT_NE(behind.said.find("drawn again 1 times"), std::string::npos) << behind.said;
  EXPECT_NE(behind.turning, usual.turning) << "the frame before";
  EXPECT_EQ(behind.resting, usual.resting);
}

TEST_F(Pipeline, IsOfNoUseWithoutNodes) {
  if (const std::string lacking = missing({Need::x_server}); !lacking.empty()) GTEST_SKIP() << lacking;
  const Shown embedded = turn_and_rest("embedded", {"--frame-latency", "1"});
  EXPECT_EQ(embedded.report.at("images_behind"), 0);
  EXPECT_EQ(embedded.turning, embedded.resting);
}

}  // namespace
}  // namespace clients
