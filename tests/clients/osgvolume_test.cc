// SPDX-License-Identifier: Apache-2.0
// A third-party viewer: OpenSceneGraph's osgvolume with its fixed-function technique (display list, texgen,
// clip planes, alpha test), in a window.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "tests/apps/viewer/virtual_display.h"
#include "tests/clients/command_test.h"
#include "tests/clients/osgvolume_command.h"

namespace clients {
namespace {

class Osgvolume : public CommandTest {
 protected:
  void SetUp() override {
    const std::string lacking =
        missing({Need::engine, Need::mpi, Need::x_server, Need::osgvolume, Need::imagemagick});
    if (!lacking.empty()) GTEST_SKIP() << lacking;
    auto started = viewer_test::VirtualDisplay::start();
    ASSERT_TRUE(started) << "Xvfb does not start";
    display_.emplace(std::move(*started));
    const Outcome bare = photograph({}, "bare.png");
    ASSERT_EQ(bare.status, 128 + SIGTERM) << bare.err;
  }

  /// osgvolume cannot save screenshots: its window is grabbed until two grabs agree and show something. It is
  /// then ended by SIGTERM, after `report` (if named) has been written.
  Outcome photograph(const Words& prefix, const std::string& name,
                     const std::map<std::string, std::string>& environment = {},
                     const std::string& report = "") {
    std::map<std::string, std::string> all = osgvolume_environment(display_->name());
    all.insert(environment.begin(), environment.end());
    Child child(command_of(prefix + osgvolume(), all), file(""));
    viewer_test::Image before;
    const bool holds_still = comes_true([&] {
      if (!child.running()) return true;
      if (!grab(name)) return false;
      const viewer_test::Image now = png(name);
      const bool same = now.rgb == before.rgb && shows_something(now);
      before = now;
      return same;
    });
    EXPECT_TRUE(holds_still && child.running()) << "osgvolume showed no image:\n" << child.err();
    if (!report.empty()) {
      EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(file(report)); }));
    }
    child.signal(SIGTERM);
    return child.finish();
  }

  std::optional<viewer_test::VirtualDisplay> display_;

 private:
  bool grab(const std::string& name) const {
    return Child({{"import", "-window", "root", "-crop", "512x512+0+0", "+repage",
                   "png24:" + file(name).string()},
                  {{"DISPLAY", display_->name()}}},
                 file(""))
               .finish()
               .status == 0;
  }

  static bool shows_something(const viewer_test::Image& image) {
    std::set<std::uint8_t> shades(image.rgb.begin(), image.rgb.end());
    return shades.size() > 16;
  }
};

TEST_F(Osgvolume, FourRanksDrawItsVolume) {
  const Outcome outcome = photograph(under({"-n", "4", "--report", file("report.json")}), "under.png");
  EXPECT_EQ(outcome.status, 128 + SIGTERM) << outcome.err;
  const nlohmann::json report = json("report.json");
  fmt::print("{}", outcome.err);
  EXPECT_EQ(report.at("nodes"), 4);
  EXPECT_GE(substituted(report), 1) << outcome.err;
  EXPECT_GE(told("osgvolume, bare and on 4 ranks", png("bare.png"), png("under.png")).psnr, 35);
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Osgvolume, TintedPixelsProveWhereTheImageCameFrom) {
  photograph(under({"-n", "4", "--debug-tint"}), "tinted.png");
  EXPECT_LT(told("osgvolume, bare and tinted", png("bare.png"), png("tinted.png")).psnr, 30);
}

TEST_F(Osgvolume, EveryMethodShowsTheSameImage) {
  photograph(under({"--report", file("audit.json")}), "audit.png");
  ASSERT_GE(substituted(json("audit.json")), 1);
  EXPECT_GE(told("osgvolume, bare and embedded", png("bare.png"), png("audit.png")).psnr, 35);
  for (const std::string injection : {"preload", "folder"}) {
    photograph(under({"--injection", injection, "--report", file(injection + ".json")}), injection + ".png");
    EXPECT_GE(substituted(json(injection + ".json")), 1) << injection;
    EXPECT_EQ(told("injection methods audit and " + injection, png("audit.png"), png(injection + ".png")).max,
              0);
  }
}

TEST_F(Osgvolume, WithoutTheLauncherTheImageIsTheSame) {
  photograph(under({}), "audit.png");
  const std::map<std::string, std::map<std::string, std::string>> ways = {
      {"preload", {{"LD_PRELOAD", libraries / "libunderstudy.so"}}},
      {"folder", {{"LD_LIBRARY_PATH", libraries / "entry"}}}};
  for (auto [way, environment] : ways) {
    environment["UNDERSTUDY_REPORT"] = file(way + ".json");
    const Outcome outcome = photograph({}, way + ".png", environment, way + ".json");
    EXPECT_GE(substituted(json(way + ".json")), 1) << way << outcome.err;
    EXPECT_EQ(told("the launcher's audit, and the loader's " + way, png("audit.png"), png(way + ".png")).max,
              0);
  }
}

TEST_F(Osgvolume, SwitchedOffEveryPixelIsTheViewersOwn) {
  photograph({}, "preload.png", {{"LD_PRELOAD", libraries / "libunderstudy.so"}, {"UNDERSTUDY_DISABLE", "1"}});
  EXPECT_EQ(told("bare, and preloaded but switched off", png("bare.png"), png("preload.png")).max, 0);
  photograph(under({}), "audit.png", {{"UNDERSTUDY_DISABLE", "1"}});
  EXPECT_EQ(told("bare, and under the launcher but switched off", png("bare.png"), png("audit.png")).max, 0);
}

}  // namespace
}  // namespace clients
