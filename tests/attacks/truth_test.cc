// SPDX-License-Identifier: Apache-2.0
// What a run reports at its end if something went wrong: incomplete chains, counters that could not be stored,
// a lost GL server.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "spu/report/report.h"
#include "tests/attacks/small_viewer.h"
#include "tests/clients/remote_viewer.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;
using clients::Child;
using clients::Outcome;
using clients::under;
using clients::Words;
using clients::operator+;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int nothing_substituted = 3;
constexpr int server_lost = 4;

class Truth : public clients::RemoteViewer {
 protected:
  Words viewer(int frames = 3) const { return small_viewer(file("volume.raw"), frames); }
};

TEST_F(Truth, AChainForViewersElsewhereIsRefusedBeforeTheViewerStarts) {
  const Outcome outcome = run(under({"--chain", "pack remote"}) + Words{"touch", file("started").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("add --remote"));
  EXPECT_FALSE(fs::exists(file("started")));
}

// The same without a launcher, which would refuse the chain.
TEST_F(Truth, AViewerWhoseChainCannotBeMadeDrawsByItself) {
  const Outcome bare = run_well(viewer() + Words{"--screenshot", file("bare.png")});
  const Outcome outcome =
      run_well(viewer() + Words{"--screenshot", file("chain.png")},
               {{"LD_PRELOAD", clients::libraries / "libunderstudy.so"}, {"UNDERSTUDY_CHAIN", "pack remote"}});
  EXPECT_THAT(outcome.err, HasSubstr("calls go straight to the driver"));
  EXPECT_EQ(png("bare.png").rgb, png("chain.png").rgb);
}

TEST_F(Truth, FiguresThatCouldNotBeWrittenAreNotZero) {
  // A runtime folder of 200 KiB in a separate mount namespace; the counters of a process are larger.
  const std::string words = fmt::format(
      "unshare --mount --map-root-user sh -c 'mount -t tmpfs -o size=200k,mode=700 none {} && exec \"$0\" "
      "\"$@\"' "
      "\"$@\"",
      runtime_.string());
  if (run({"sh", "-c", words, "sh", "true"}).status != 0) GTEST_SKIP() << "no file system can be mounted here";
  const Outcome outcome = run(Words{"sh", "-c", words, "sh"} + under({"--require"}) + viewer());
  EXPECT_THAT(outcome.err, HasSubstr("cannot be kept in"));
  EXPECT_THAT(outcome.err, HasSubstr("could not be written to"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("0 volumes seen")));
  EXPECT_EQ(outcome.status, nothing_substituted) << "what was required is not shown to be";
}

TEST_F(Truth, WhereSubstitutionIsRequiredTheStatusTells) {
  EXPECT_EQ(run(under({"--require"}) + viewer()).status, 0);
  EXPECT_EQ(run(under({"--require"}) + Words{"true"}).status, nothing_substituted);
  EXPECT_EQ(run(under() + Words{"true"}).status, 0);
  EXPECT_EQ(run(under({"--require"}) + Words{"sh", "-c", "exit 7"}).status, 7) << "the viewer's own";
}

std::string command_line_of(pid_t process) {
  std::string words = clients::contents(fmt::format("/proc/{}/cmdline", process));
  std::replace(words.begin(), words.end(), '\0', ' ');
  return words;
}

class LostServer : public Truth {
 protected:
  void SetUp() override { start_display({clients::Need::x_server}); }

  std::uint64_t frames_shown() const {
    std::uint64_t frames = 0;
    for (const auto& folder : fs::directory_iterator(runtime_))
      for (const auto& process : understudy::spu::read_counters(folder)) frames += process->remote.frames;
    return frames;
  }

  /// Runs a viewer and kills its GL server after some frames.
  Outcome lose_server(const Words& options) {
    Words words = clients::RemoteViewer::without_opengl() + viewer(2000);
    std::erase(words, "--offscreen");
    Child child(CommandTest::command_of(under(Words{"--remote"} + options) + words, on_display()), file(""));
    EXPECT_TRUE(clients::comes_true([&] { return !child.running() || frames_shown() > 3; }));
    for (const pid_t process : processes("understudy"))
      if (command_line_of(process).find("gl-server --socket") != std::string::npos) ::kill(process, SIGKILL);
    return child.finish();
  }
};

TEST_F(LostServer, IsInTheSummaryAndInTheReport) {
  const Outcome outcome = lose_server({"--report", file("report.json")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("; the GL server was lost: "));
  const nlohmann::json report = json("report.json");
  EXPECT_EQ(report.at("server_connection").at("lost"), true);
  EXPECT_GT(report.at("server_connection").at("frames_lost"), 0);
}

TEST_F(LostServer, IsStatusFourWhereSubstitutionIsRequired) {
  EXPECT_EQ(lose_server({"--require"}).status, server_lost);
}

}  // namespace
}  // namespace attacks
