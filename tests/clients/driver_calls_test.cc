// No slice reaches the driver to be drawn: a recording of the calls below Understudy, by apitrace.
//
// apitrace is made to be the first library that a program calls; here it has to be the second. Two settings
// bring that about. LD_PRELOAD names Understudy before apitrace's library and the real OpenGL after it, which
// is where apitrace looks for the driver (RTLD_NEXT). UNDERSTUDY_DRIVER_DIR is a folder in which the driver's
// names lead to apitrace's library. (In front of us it stands in tests/doors/tracer_test.cc.)
//
// What Understudy asks of the driver itself stays in the recording: it has the slices' vertices computed by the
// viewer's own pipeline (feedback mode, or transform feedback without rasterisation), which makes no pixel, and
// draws triangles over the picture: its probes of the transfer function into a framebuffer of its own, and the
// result into the window.
// osgvolume's slices write depth besides, so its first frame has them once more, for depth alone; as nothing
// looks at that depth, no later frame has.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/osgvolume_command.h"
#include "tests/clients/recording.h"
#include "tests/clients/stage.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using testing::Each;
using testing::IsEmpty;
using testing::Not;

constexpr const char* whole_picture = "glDrawArrays(mode = GL_TRIANGLES, first = 0, count = 3)";

class DriverCalls : public Stage {
 protected:
  std::vector<RecordedFrame> dumped(const std::string& name) const {
    const Outcome dump = run_well({"apitrace", "dump", "--color=never", file(name)});
    return frames_in(dump.out);
  }

  std::vector<RecordedFrame> bare(const std::string& api, const Words& viewer,
                                  const std::map<std::string, std::string>& environment) const {
    run_well(Words{"apitrace", "trace", "-a", api, "-o", file("bare.trace")} + viewer, environment);
    return dumped("bare.trace");
  }

  /// The driver's call interface as apitrace's library (egltrace.so, glxtrace.so), and the two real libraries
  /// behind it.
  std::vector<RecordedFrame> below_understudy(const std::string& wrapper, const std::string& window_system,
                                              const Words& viewer,
                                              const std::map<std::string, std::string>& environment) const {
    const fs::path recorder = system_libraries / "apitrace/wrappers" / wrapper;
    const fs::path drivers = file("drivers");
    fs::create_directory(drivers);
    fs::create_symlink(recorder, drivers / window_system);
    fs::create_symlink(recorder, drivers / "libOpenGL.so.0");
    std::string preload = libraries / "libunderstudy.so";
    for (const fs::path& library :
         {recorder, system_libraries / window_system, system_libraries / "libOpenGL.so.0"})
      preload += ":" + library.string();
    // The first frame's check against the viewer's own drawing would put its slices into a framebuffer of ours.
    const Words recorded = {"env", "LD_PRELOAD=" + preload, "UNDERSTUDY_DRIVER_DIR=" + drivers.string(),
                            "TRACE_FILE=" + file("below.trace").string()};
    const Outcome outcome = run_well(
        under({"--door", "preload", "--verify=-1", "--report", file("report.json")}) + recorded + viewer,
        environment);
    fmt::print("{}", outcome.err.substr(outcome.err.rfind("understudy: ")));
    return dumped("below.trace");
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
      EXPECT_THAT(bare[i].onto_window, Each(Not(whole_picture)));
      EXPECT_THAT(below[i].onto_window, Not(IsEmpty())) << "the result has to get there";
      EXPECT_THAT(below[i].onto_window, Each(whole_picture));
      EXPECT_THAT(below[i].onto_own, Each(whole_picture));
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
  expect_no_slices(bare("egl", viewer, {}), below_understudy("egltrace.so", "libEGL.so.1", viewer, {}));
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
  expect_no_slices(bare("gl", osgvolume(), environment),
                   below_understudy("glxtrace.so", "libGLX.so.0", osgvolume(), environment));
}

}  // namespace
}  // namespace clients
