// SPDX-License-Identifier: Apache-2.0
// Damaged files, and machines that lack something: a clear message, the viewer's own exit status, nothing left
// behind.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>

#include "apps/understudy/images/image.h"
#include "tests/clients/command_test.h"
#include "tests/clients/osgvolume_command.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class BadInput : public CommandTest {
 protected:
  Words viewer(const fs::path& volume, const Words& options = {}) const {
    return Words{(programs / "understudy-viewer").string(),
                 volume.string(),
                 "--offscreen",
                 "--window-size",
                 "128",
                 "128"} +
           options;
  }
};

TEST_F(BadInput, AVolumeFileThatIsTruncatedOrMissingIsTheViewersErrorAndItsStatus) {
  folder_.write("short.32x32x32", std::string(1000, 'x'));
  const std::vector<std::pair<std::string, testing::Matcher<std::string>>> cases = {
      {"short.32x32x32", AllOf(HasSubstr("truncated"), HasSubstr("expected 32768 bytes, found 1000"))},
      {"absent.32x32x32", HasSubstr("no such file")}};
  for (const auto& [name, message] : cases) {
    const Outcome bare = run(viewer(file(name)));
    const Outcome below = run(under({"--report", file("report.json")}) + viewer(file(name)));
    fmt::print("status {}: {}", below.status, below.err);
    EXPECT_NE(bare.status, 0);
    EXPECT_EQ(below.status, bare.status);
    EXPECT_THAT(below.err, AllOf(message, HasSubstr(file(name).string()), HasSubstr("; ")))
        << "what, where, and what to do next";
    EXPECT_TRUE(below.err.starts_with(bare.err)) << "the viewer's own message: " << bare.err;
    EXPECT_EQ(json("report.json").at("volumes").size(), 0U);
  }
  EXPECT_EQ(leftovers(), "");
}

TEST_F(BadInput, WhereMpiIsMissingTheViewersProcessDoesTheWork) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(engine_viewer("table", {"--screenshot", file("bare.png")}));
  const Outcome outcome = run_well(under({"-n", "4", "--report", file("report.json")}) +
                                       engine_viewer("table", {"--screenshot", file("under.png")}),
                                   {{"PATH", "/nowhere"}});
  fmt::print("{}", outcome.err);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("mpirun is not on PATH"), HasSubstr("apt install "),
                    HasSubstr("inside the viewer instead"), HasSubstr("1 substituted (embedded)")));
  EXPECT_EQ(json("report.json").at("nodes"), 0);
  EXPECT_GE(told("without MPI", png("bare.png"), png("under.png")).psnr, 40);
  EXPECT_EQ(leftovers(), "");
}

TEST_F(BadInput, WithoutADisplayEveryViewerFailsAsItWouldAlone) {
  const std::map<std::string, std::string> no_display = {{"DISPLAY", ":99999"}};
  folder_.write("ball.16x16x16", std::string(4096, 'x'));
  std::vector<Words> viewers = {{(programs / "understudy-viewer").string(), file("ball.16x16x16").string()}};
  if (missing({Need::engine, Need::osgvolume}).empty()) viewers.push_back(osgvolume());
  for (const Words& words : viewers) {
    // osgvolume reports "could not create display" and exits with status 0, which must be passed on as well.
    const Outcome bare = run(words, no_display);
    for (const char* injection : {"audit", "preload", "folder"}) {
      const Outcome below = run(under({"--injection", injection}) + words, no_display);
      fmt::print("{} without a display: alone {}, behind {} {}\n", words.front(), bare.status, injection,
                 below.status);
      EXPECT_EQ(below.status, bare.status) << below.err;
    }
  }
  EXPECT_EQ(leftovers(), "");
}

TEST_F(BadInput, AViewerThatDoesNotExistIsNamedAndTheStatusIsTheShells) {
  const Outcome outcome = run(under({}) + Words{"/no/such/program"});
  fmt::print("{}", outcome.err);
  EXPECT_EQ(outcome.status, 127);
  EXPECT_THAT(outcome.err, HasSubstr("cannot start /no/such/program: No such file or directory"));
  EXPECT_EQ(leftovers(), "");
}

TEST_F(BadInput, VoxelsThatAreNoNumbersGiveAFiniteImageEverywhereElse) {
  constexpr int edge = 48;
  std::vector<float> voxels;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        voxels.push_back(static_cast<float>(1 - std::hypot(x - 23.5, y - 23.5, z - 23.5) / 24));
  for (std::size_t i = 0; i < voxels.size(); i += 97) voxels[i] = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 5; i < voxels.size(); i += 1013) voxels[i] = std::numeric_limits<float>::infinity();
  const std::string path = folder_.write("holes.48x48x48.f32.raw", std::as_bytes(std::span(voxels)));
  for (const std::string mode : {"rgba", "table", "core"}) {
    const Words words = viewer(path, {"--mode", mode, "--type", "f32", "--preset", "dense", "--no-frame"});
    run_well(words + Words{"--screenshot", file("bare.png")});
    const Outcome outcome = run_well(under({"--save-frames", file(mode), "--report", file("report.json")}) +
                                     words + Words{"--screenshot", file("under.png")});
    ASSERT_EQ(substituted(json("report.json")), 1) << outcome.err;
    const auto frame = understudy::launcher::read_image(file(mode) / "frame_0000.pfm");
    EXPECT_TRUE(std::all_of(frame.rgba.begin(), frame.rgba.end(), [](float v) { return std::isfinite(v); }));
    EXPECT_GE(told(mode + ", a volume with NaN and infinities", png("bare.png"), png("under.png")).psnr, 35);
  }
}

class Serve : public CommandTest {
 protected:
  void SetUp() override {
    if (const std::string lacking = missing({Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  }
  Words serve(const fs::path& socket) const {
    return {(programs / "understudy").string(), "serve", "-n", "2", "--socket", socket.string()};
  }
};

TEST_F(Serve, ATakenSocketIsNamedAndStaysTheFirstOnes) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  const fs::path socket = file("nodes.sock");
  Child first(command_of(serve(socket)), file(""));
  ASSERT_TRUE(
      comes_true([&] { return !first.running() || first.out().find("2 nodes at") != std::string::npos; }));
  ASSERT_TRUE(first.running()) << first.err();

  const Outcome second = run(serve(socket));
  fmt::print("status {}: {}", second.status, second.err);
  EXPECT_NE(second.status, 0);
  EXPECT_THAT(second.err,
              AllOf(HasSubstr(socket.string()), HasSubstr("in use"), HasSubstr("name another path")));

  const Outcome viewer = run_well(under({"--connect", socket, "--report", file("report.json")}) +
                                  engine_viewer("table", {"--screenshot", file("under.png")}));
  EXPECT_EQ(json("report.json").at("nodes"), 2) << viewer.err;
  EXPECT_EQ(substituted(json("report.json")), 1) << viewer.err;
  first.signal(SIGTERM);
  const Outcome served = first.finish();
  EXPECT_EQ(served.status, 0);
  fmt::print("the first one said: {}", served.err);
  EXPECT_FALSE(fs::exists(socket));
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Serve, ASocketThatCannotBeMadeSaysWhereAndWhy) {
  const fs::path plain_file = folder_.write("notes.txt", std::string("kept"));
  for (const fs::path& socket : {file("no/such/folder/nodes.sock"), fs::path("/proc/nodes.sock"), plain_file,
                                 file(std::string(200, 'x'))}) {
    const Outcome outcome = run(serve(socket));
    fmt::print("status {}: {}", outcome.status, outcome.err);
    EXPECT_GT(outcome.status, 0);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(socket.string()), testing::ContainsRegex("name|choose")));
  }
  EXPECT_EQ(contents(plain_file), "kept");
  EXPECT_EQ(leftovers(), "");
}

TEST_F(Serve, AViewerWhoseNodesAreNotThereDrawsByItself) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(engine_viewer("table", {"--screenshot", file("bare.png")}));
  const Outcome outcome = run_well(under({"--connect", file("absent.sock"), "--report", file("report.json")}) +
                                   engine_viewer("table", {"--screenshot", file("under.png")}));
  fmt::print("{}", outcome.err);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("no render nodes at '" + file("absent.sock").string()),
                                 HasSubstr("understudy serve"), HasSubstr("the render nodes did not answer"),
                                 testing::Not(HasSubstr("embedded"))));
  EXPECT_EQ(substituted(json("report.json")), 0);
  EXPECT_EQ(told("nodes that are not there", png("bare.png"), png("under.png")).max, 0);
}

}  // namespace
}  // namespace clients
