// SPDX-License-Identifier: Apache-2.0
// `understudy ctl` and a viewer that draws frame after frame: what is switched off is the viewer's own image,
// bit for bit, and whatever is sent to its socket, the viewer goes on.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "compositor/transport/socket.h"
#include "tests/attacks/small_viewer.h"
#include "tests/clients/command_test.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::testing::HasSubstr;
using understudy::compositor::connect_to;
using understudy::compositor::FileDescriptor;

constexpr const char* switched_off = "switched off with understudy ctl";

class ControlledViewer : public CommandTest {
 protected:
  /// The bundled viewer with a camera at rest, so that all of its own frames are equal.
  Words viewer(const Words& options = {}, int frames = 1'000'000) const {
    Words words = attacks::small_viewer(file("volume.raw"), frames);
    *(std::ranges::find(words, "--orbit") + 1) = "0";
    return words + Words{"--print-times"} + options;
  }
  Words with_frames(const std::string& folder) const { return {"--screenshot-frames", file(folder).string()}; }

  /// Throws std::runtime_error if it ends at once.
  void start(const Words& options, const Words& command) {
    child_.emplace(command_of(under(options) + command), file(""));
    wait_for_frames(3);
  }
  void wait_for_frames(int frames) {
    if (!comes_true([&] { return !child_->running() || frames_shown() > frames; }) || !child_->running())
      throw std::runtime_error("the viewer does not draw: " + child_->err());
  }

  Outcome ctl(const Words& words) const {
    return run(Words{(programs / "understudy").string(), "ctl"} + words);
  }
  Outcome ctl_well(const Words& words) const {
    Outcome outcome = ctl(words);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    return outcome;
  }
  Json status() const { return Json::parse(ctl_well({"status", "--json"}).out); }

  /// Frames that the viewer has printed as finished.
  int frames_shown() const {
    const std::string out = child_->out();
    int frames = 0;
    for (std::size_t at = 0; (at = out.find("\nframe ", at)) != std::string::npos; ++at)
      frames += out.find('\n', at + 1) != std::string::npos ? 1 : 0;
    return frames;
  }
  /// Waits until the viewer has drawn some frames that began after now.
  void let_it_draw() { wait_for_frames(frames_shown() + 3); }
  /// The image of a frame that began after now.
  viewer_test::Image next_image(const std::string& folder) {
    const int number = frames_shown() + 2;
    let_it_draw();
    return png(folder + fmt::format("/frame_{:04}.png", number));
  }
  /// What the viewer draws without Understudy.
  viewer_test::Image own_image(const std::string& mode = "table") const {
    run_well(viewer({"--mode", mode, "--screenshot", file("own.png").string()}, 1));
    return png("own.png");
  }

  fs::path folder() const { return runtime_ / "understudy"; }
  fs::path socket() const { return fs::directory_iterator(folder())->path(); }
  FileDescriptor connect() const { return connect_to(socket(), deadline()); }
  static understudy::compositor::Deadline deadline() {
    return understudy::compositor::Clock::now() + std::chrono::seconds(60);
  }
  static void send(const FileDescriptor& to, const std::string& text) {
    (void)!::send(to.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }

  void end() {
    child_->signal(SIGTERM);
    EXPECT_EQ(child_->finish().status, 128 + SIGTERM);
    EXPECT_EQ(leftovers(), "");
  }

  std::optional<Child> child_;
};

TEST_F(ControlledViewer, IsListedWithItsFigures) {
  start({}, viewer());
  const Json viewers = Json::parse(ctl_well({"list", "--json"}).out);
  ASSERT_EQ(viewers.size(), 1U);
  EXPECT_EQ(viewers[0]["pid"], processes("understudy-viewer").front());
  EXPECT_THAT(viewers[0]["program"].get<std::string>(), ::testing::EndsWith("/understudy-viewer"));
  EXPECT_THAT(viewers[0]["since"].get<std::string>(), ::testing::MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_GT(viewers[0]["frames"], 0);
  EXPECT_GT(viewers[0]["frames_substituted"], 0);
  EXPECT_EQ(viewers[0]["nodes"], 0);
  EXPECT_LT(viewers[0]["worst_tile"], 1);
  EXPECT_THAT(ctl_well({"list"}).out, HasSubstr("understudy-viewer, since 20"));
  end();
  EXPECT_EQ(ctl_well({"list", "--json"}).out, "[]\n");
}

TEST_F(ControlledViewer, SwitchedOffDrawsItsOwnImagesBitForBitUntilItIsSwitchedOn) {
  for (const std::string mode : {"table", "stacks", "core", "bricks"}) {
    const viewer_test::Image own = own_image(mode);
    start({}, viewer(with_frames(mode) + Words{"--mode", mode}));
    EXPECT_GT(told(mode + ", substituted", next_image(mode), own).max, 0);
    EXPECT_THAT(ctl_well({"off"}).out, HasSubstr("substitution off"));
    EXPECT_EQ(next_image(mode).rgb, own.rgb) << mode;
    const Json before = status();
    let_it_draw();
    const Json after = status();
    EXPECT_EQ(before["frames_substituted"], after["frames_substituted"]) << mode;
    EXPECT_LT(before["frames_left"], after["frames_left"]) << mode;
    EXPECT_EQ(before["volumes"][0]["probes"], after["volumes"][0]["probes"]) << mode;
    EXPECT_GT(after["volumes"][0]["left_because"].value(switched_off, 0), 0) << mode << after["volumes"];
    EXPECT_EQ(after["control"]["substitution"], false);
    ctl_well({"on"});
    let_it_draw();
    EXPECT_GT(status()["frames_substituted"], after["frames_substituted"]) << mode;
    end();
    EXPECT_THAT(child_->err(), HasSubstr(switched_off)) << "in the summary of the run";
  }
}

TEST_F(ControlledViewer, StatusHasTheKeysOfTheReport) {
  start({"--report", file("report.json").string()}, viewer());
  Json now = status();
  EXPECT_LE(now["frames_detail"].size(), 16U);
  EXPECT_TRUE(now["control"]["obstacle"].is_null());
  end();
  now.erase("control");
  Json report = json("report.json");
  for (const auto& [key, value] : now.items()) EXPECT_TRUE(report.contains(key)) << key;
  // What only the launcher has.
  for (const char* const key : {"origin", "backends", "connection"}) report.erase(key);
  for (const auto& [key, value] : report.items()) EXPECT_TRUE(now.contains(key)) << key;
}

TEST_F(ControlledViewer, TintAndBudgetChangeWhileItRuns) {
  const viewer_test::Image own = own_image();
  start({}, viewer(with_frames("frames")));
  ctl_well({"tint", "understudy-viewer", "on"});
  EXPECT_GT(told("tinted", next_image("frames"), own).rms, 20);
  ctl_well({"tint", "off"});
  EXPECT_LT(told("tint off", next_image("frames"), own).rms, 2);
  EXPECT_THAT(ctl_well({"set", "error", "2/255"}).out, HasSubstr("error 0.0078"));
  let_it_draw();
  EXPECT_NEAR(status()["volumes"][0]["budget"]["asked"].get<double>(), 2.0 / 255, 1e-9);
  EXPECT_THAT(ctl_well({"set", "time", "30ms"}).out, HasSubstr("time 30 ms"));
  let_it_draw();
  const Json timed = status()["volumes"][0]["budget"];
  EXPECT_TRUE(timed["asked"].is_null()) << timed;
  EXPECT_EQ(timed["asked_ms"], 30) << timed;
  ctl_well({"set", "none"});
  let_it_draw();
  EXPECT_TRUE(status()["volumes"][0]["budget"].is_null());
  EXPECT_LT(told("no budget", next_image("frames"), own).rms, 2);
  end();
}

TEST_F(ControlledViewer, WhateverIsSentToItsSocketGoesOn) {
  start({}, viewer());
  std::vector<FileDescriptor> kept;
  for (const std::string& garbage :
       {std::string("\n\n\n"), std::string("{"), std::string(1'000'000, 'x'), std::string(4000, '[') + "\n",
        std::string("\0\xff\n", 3), std::string(R"({"version":1,"command":"tint","on":[]})") + "\n",
        std::string(R"({"version":1e999,"command":"status"})") + "\n"}) {
    kept.push_back(connect());
    send(kept.back(), garbage);
  }
  // Requests whose answers nobody reads.
  for (int i = 0; i < 40; ++i) {
    kept.push_back(connect());
    send(kept.back(), "{\"version\":1,\"command\":\"status\"}\n");
  }
  let_it_draw();
  EXPECT_EQ(status()["control"]["substitution"], true);
  EXPECT_EQ(status()["control"]["tint"], false);
  let_it_draw();
  end();
}

TEST_F(ControlledViewer, IsNotControlledInAFolderThatOthersMayLookInto) {
  fs::create_directory(folder());
  ::chmod(folder().c_str(), 0755);
  start({}, viewer());
  EXPECT_TRUE(fs::is_empty(folder()));
  EXPECT_THAT(child_->err(), HasSubstr("is not a folder of yours with mode 0700"));
  const Outcome outcome = ctl({"off"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("is not a folder of yours with mode 0700"));
  child_->signal(SIGTERM);
  child_->finish();
}

TEST_F(ControlledViewer, HasNoSocketIfThatIsSwitchedOff) {
  start({"--control", "off"}, viewer());
  EXPECT_FALSE(fs::exists(folder()));
  const Outcome outcome = ctl({"off"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no viewer of yours runs under Understudy"));
  end();
}

TEST_F(ControlledViewer, LeavesALimitedAddressSpaceToTheDriver) {
  const Words limited = Words{"sh", "-c", "ulimit -v 16000000 && exec \"$@\"", "sh"} + viewer();
  start({}, limited);
  EXPECT_THAT(child_->err(), HasSubstr("`ulimit -v`"));
  EXPECT_FALSE(fs::exists(folder()));
  end();
  start({"--control", "on"}, limited);
  EXPECT_TRUE(fs::exists(folder()));
  end();
}

TEST_F(ControlledViewer, WithoutALauncherHasASocketOnlyIfThatIsAskedFor) {
  const auto preloaded = [&](const std::string& control, int frames) {
    return command_of(viewer({}, frames),
                      {{"LD_PRELOAD", libraries / "libunderstudy.so"}, {"UNDERSTUDY_CONTROL", control}});
  };
  child_.emplace(preloaded("", 1'000'000), file(""));
  wait_for_frames(3);
  EXPECT_FALSE(fs::exists(folder()));
  child_.emplace(preloaded("on", 1'000'000), file(""));
  wait_for_frames(3);
  ctl_well({"off"});
  let_it_draw();
  EXPECT_GT(status()["frames_left"], 0);
  child_.reset();
  EXPECT_EQ(ctl_well({"list", "--json"}).out, "[]\n") << "its socket remains, but nobody listens";
  EXPECT_EQ(Child(preloaded("on", 3), file("")).finish().status, 0);
  EXPECT_FALSE(fs::exists(folder())) << "a program that exits removes its socket";
}

TEST_F(ControlledViewer, OfAGlServerIsListedAndSaysWhyItCannotBeChanged) {
  start({"--remote"}, viewer());
  EXPECT_EQ(Json::parse(ctl_well({"list", "--json"}).out).size(), 1U);
  const Outcome outcome = ctl({"off"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("--remote"));
  end();
}

TEST_F(ControlledViewer, OneOfSeveralIsNamedByItsProcess) {
  start({}, viewer());
  Child second(command_of(under() + viewer()), file(""));
  ASSERT_TRUE(comes_true([&] {
    return !second.running() || Json::parse(ctl_well({"list", "--json"}).out).size() == 2;
  }));
  const Outcome several = ctl({"off"});
  EXPECT_EQ(several.status, 1);
  EXPECT_THAT(several.err, HasSubstr("give the process id of one"));
  const std::vector<pid_t> viewers = processes("understudy-viewer");
  ASSERT_EQ(viewers.size(), 2U);
  ctl_well({"off", std::to_string(viewers.front())});
  const Outcome unknown = ctl({"off", "1"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("'1'"));
  second.signal(SIGTERM);
  second.finish();
  end();
}

TEST_F(ControlledViewer, AWrongCommandLineIsRefused) {
  for (const Words& words : std::vector<Words>{{},
                                               {"stop"},
                                               {"tint"},
                                               {"tint", "maybe"},
                                               {"set", "error"},
                                               {"set", "error", "2"},
                                               {"set", "colour", "red"},
                                               {"off", "1", "2"},
                                               {"list", "1"}}) {
    const Outcome outcome = ctl(words);
    EXPECT_EQ(outcome.status, 2) << fmt::format("{}", fmt::join(words, " ")) << outcome.err;
  }
}

}  // namespace
}  // namespace clients
