// SPDX-License-Identifier: Apache-2.0
// GL servers without EGL: they draw on OSMesa, and the viewer gets the same images as with EGL.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "tests/clients/remote_viewer.h"

namespace clients {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class RemoteOsmesa : public RemoteViewer {
 protected:
  void SetUp() override { start_display({Need::engine, Need::x_server}); }

  /// Runs two frames of a viewer without OpenGL, and writes a report.
  Outcome run_remote(const std::string& folder, const std::string& mode, const Words& options,
                     std::map<std::string, std::string> environment = {}) const {
    environment["DISPLAY"] = display_->name();
    return run_well(under(Words{"--remote", "--report", file(folder + ".json")} + options) +
                        viewer(mode, {"--frames", "2", "--orbit", "50", "--screenshot-frames", file(folder)}),
                    environment);
  }

  void expect_substituted_and_alike(const std::string& a, const std::string& b) const {
    for (const std::string& folder : {a, b}) {
      EXPECT_EQ(json(folder + ".json").at("remote"), true);
      EXPECT_EQ(json(folder + ".json").at("frames"), 2);
      EXPECT_EQ(substituted(json(folder + ".json")), 2) << folder;
    }
    for (const char* name : {"frame_0000.png", "frame_0001.png"}) {
      EXPECT_GE(told(fmt::format("{} and {}, {}", a, b, name), png(a + "/" + name), png(b + "/" + name)).psnr,
                50);
    }
  }

  void expect_same_images(const std::string& mode, const Words& nodes) const {
    run_remote("egl", mode, nodes + Words{"--server-opengl", "egl"});
    const Outcome outcome = run_remote("osmesa", mode, nodes + Words{"--server-opengl", "osmesa"});
    EXPECT_THAT(outcome.err, Not(HasSubstr("OSMesa"))) << "nobody is told what he asked for";
    expect_substituted_and_alike("egl", "osmesa");
    EXPECT_EQ(leftovers(), "");
  }
};

TEST_F(RemoteOsmesa, ShowsWhatAStageOnEglShows) {
  expect_same_images("table", {});
}

TEST_F(RemoteOsmesa, CoreContextsAndNodes) {
  if (const std::string lacking = missing({Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  expect_same_images("core", {"-n", "2"});
}

/// The system's libOSMesa is loaded, and no library of Mesa's EGL in addition.
TEST_F(RemoteOsmesa, TheGlServerOpensTheSystemsLibraryAlone) {
  Child child(command_of(under({"--remote", "--server-opengl", "osmesa"}) +
                             viewer("table", {"--frames", "100000", "--orbit", "1"}),
                         {{"DISPLAY", display_->name()}}),
              file(""));
  const auto mapped_by_a_gl_server = [&] {
    for (const pid_t process : processes("understudy")) {
      std::string mapped = contents(fmt::format("/proc/{}/maps", process));
      if (mapped.find("libOSMesa") != std::string::npos) return mapped;
    }
    return std::string();
  };
  std::string mapped;
  ASSERT_TRUE(comes_true([&] {
    mapped = mapped_by_a_gl_server();
    return !mapped.empty() || !child.running();
  })) << child.err();
  EXPECT_THAT(mapped, HasSubstr((system_libraries / "libOSMesa").string()));
  for (const char* other : {"libEGL", "_dri.so", "libunderstudy"}) EXPECT_THAT(mapped, Not(HasSubstr(other)));
  child.signal(SIGTERM);
  EXPECT_EQ(child.finish().status, 128 + SIGTERM);
  EXPECT_EQ(leftovers(), "");
}

TEST_F(RemoteOsmesa, TakesThePlaceOfEglAndSaysWhy) {
  run_remote("egl", "table", {"--server-opengl", "egl"});
  // Without a vendor's library, and without a driver.
  const Outcome no_vendor =
      run_remote("no_vendor", "table", {}, {{"__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere"}});
  EXPECT_THAT(no_vendor.err,
              HasSubstr("drawing on OSMesa, because EGL has no display without a window system"));
  expect_substituted_and_alike("egl", "no_vendor");
  const Outcome no_driver = run_remote("no_driver", "table", {}, {{"LIBGL_DRIVERS_PATH", "/nowhere"}});
  EXPECT_THAT(no_driver.err, HasSubstr("drawing on OSMesa, because EGL"));
  expect_substituted_and_alike("egl", "no_driver");
  EXPECT_EQ(leftovers(), "");
}

TEST_F(RemoteOsmesa, WhoAsksForEglAloneIsToldWhatIsMissing) {
  const Outcome outcome =
      run(under({"--remote", "--server-opengl", "egl"}) + viewer("table", {"--frames", "1"}),
          {{"DISPLAY", display_->name()}, {"__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere"}});
  EXPECT_NE(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("install libegl-mesa0"));
  EXPECT_EQ(leftovers(), "");
}

TEST_F(RemoteOsmesa, AStageElsewhereIsNotThisRunsToChoose) {
  const Outcome outcome = run_well(under({"--server-opengl", "osmesa"}) + viewer("table", {"--frames", "1"}),
                                   {{"DISPLAY", display_->name()}});
  EXPECT_THAT(outcome.err, HasSubstr("give it to understudy serve --gl-server"));
}

}  // namespace
}  // namespace clients
