// SPDX-License-Identifier: Apache-2.0
// No slice is drawn by the driver, as shown by an apitrace recording of the calls below Understudy.
//
// The recording also contains Understudy's own calls. The slices' vertices are computed by the viewer's
// pipeline (in feedback mode, or by transform feedback without rasterisation), which generates no pixels.
// Triangles are drawn over images: probes of the transfer function into a framebuffer of Understudy's, and the
// result into the window. osgvolume's slices also write depth, so its first frame draws them once more for
// depth alone; as nothing reads that depth, later frames do not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/osgvolume_command.h"
#include "tests/clients/recording.h"
#include "tests/clients/recording_test.h"

namespace clients {
namespace {

using testing::Each;
using testing::IsEmpty;
using testing::Not;

constexpr const char* whole_image = "glDrawArrays(mode = GL_TRIANGLES, first = 0, count = 3)";

class DriverCalls : public RecordingTest {
 protected:
  std::vector<RecordedFrame> bare(const RecordedLibrary& library, const Words& viewer,
                                  const std::map<std::string, std::string>& environment) const {
    return frames_in(dump_of_bare(library, viewer, environment));
  }

  std::vector<RecordedFrame> below_understudy(const RecordedLibrary& library, const Words& viewer,
                                              const std::map<std::string, std::string>& environment) const {
    // Verification of the first frame would draw the viewer's slices into a framebuffer of Understudy's.
    return frames_in(dump_of_driver(library, {"--verify=-1"}, viewer, environment));
  }

  static void expect_no_slices(const std::vector<RecordedFrame>& bare,
                               const std::vector<RecordedFrame>& below) {
    ASSERT_GE(bare.size(), 3U);
    ASSERT_EQ(below.size(), bare.size());
    for (std::size_t i = 0; i < below.size(); ++i) {
      SCOPED_TRACE(fmt::format("frame {}", i));
      fmt::print("frame {}: the viewer alone draws {}\n", i, summary(bare[i].onto_window));
      fmt::print(
          "  under Understudy the driver draws {} onto the window, {} onto framebuffers of its own, {} for "
          "depth "
          "alone, and computes the vertices of {}\n",
          summary(below[i].onto_window), summary(below[i].onto_own), summary(below[i].depth_alone),
          summary(below[i].without_pixels));
      EXPECT_THAT(bare[i].onto_window, Not(IsEmpty()));
      EXPECT_THAT(bare[i].onto_window, Each(Not(whole_image)));
      EXPECT_THAT(below[i].onto_window, Not(IsEmpty())) << "the result has to get there";
      EXPECT_THAT(below[i].onto_window, Each(whole_image));
      EXPECT_THAT(below[i].onto_own, Each(whole_image));
      if (i > 0) {
        EXPECT_THAT(below[i].depth_alone, IsEmpty());
      }
    }
  }
};

class DriverCallsOfTheBundledViewer : public DriverCalls, public testing::WithParamInterface<const char*> {};

TEST_P(DriverCallsOfTheBundledViewer, HoldNoSliceThatMakesPixels) {
  if (const std::string lacking = missing({Need::engine, Need::apitrace}); !lacking.empty())
    GTEST_SKIP() << lacking;
  const Words viewer = engine_viewer(GetParam(), {"--no-frame", "--frames", "3", "--orbit", "5"});
  expect_no_slices(bare(egl, viewer, {}), below_understudy(egl, viewer, {}));
}

INSTANTIATE_TEST_SUITE_P(Mode, DriverCallsOfTheBundledViewer, testing::Values("rgba", "table", "core"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(DriverCalls, OfOsgvolumeHoldNoSliceThatMakesPixels) {
  const std::string lacking = missing({Need::engine, Need::apitrace, Need::x_server, Need::osgvolume});
  if (!lacking.empty()) GTEST_SKIP() << lacking;
  const auto display = viewer_test::VirtualDisplay::start();
  ASSERT_TRUE(display) << "Xvfb does not start";
  auto environment = osgvolume_environment(display->name());
  environment["OSG_RUN_FRAME_COUNT"] = "3";
  expect_no_slices(bare(glx, osgvolume(), environment), below_understudy(glx, osgvolume(), environment));
}

}  // namespace
}  // namespace clients
