// SPDX-License-Identifier: Apache-2.0
// Render nodes on four hosts, and a viewer on the first: the image is that of one machine, over a network, and
// the viewer goes on when a host is cut off or a rank stops.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "apps/understudy/cli/compare.h"
#include "apps/understudy/images/image.h"
#include "tests/clients/command_test.h"
#include "tests/hosts/own_namespaces.h"

namespace hosts {
namespace {

namespace fs = std::filesystem;
using clients::Child;
using clients::comes_true;
using clients::contents;
using clients::Outcome;
using clients::Words;
using clients::operator+;

constexpr int all_hosts = 4;
constexpr int microseconds_on_the_way = 200;
/// Frames of a full turn, after which images repeat.
constexpr int turn = 12;

const Words turning = {"--orbit", "30"};

/// The four hosts, shared by all tests of this program.
class Network : public testing::Environment {
 public:
  explicit Network(std::string obstacle) : obstacle_(std::move(obstacle)) { shared() = this; }
  static Network*& shared() {
    static Network* network = nullptr;
    return network;
  }

  void SetUp() override {
    for (const char* program : {"ip", "tc"})
      if (obstacle_.empty() && std::system(fmt::format("command -v {} >/dev/null", program).c_str()) != 0)
        obstacle_ = fmt::format("there is no {} (apt install iproute2)", program);
    if (!obstacle_.empty()) return;
    folder_ = std::make_unique<viewer_test::TemporaryFolder>();
    const Outcome made =
        Child({{HOSTS_FOLDER "/network.sh", DELAYING_SWITCH, std::to_string(microseconds_on_the_way),
                std::to_string(all_hosts), folder_->file("")},
               {}},
              folder_->file(""))
            .finish();
    if (made.status != 0) obstacle_ = "no network can be made here: " + made.out + made.err;
  }
  void TearDown() override { folder_.reset(); }

  /// Why there is no network; empty if there is one.
  const std::string& obstacle() const { return obstacle_; }

 private:
  std::string obstacle_;
  std::unique_ptr<viewer_test::TemporaryFolder> folder_;
};

std::string host(int number) {
  return fmt::format("host{}", number);
}

Words on_host(int number, const Words& words) {
  return Words{"ip",         "netns",   "exec",
               host(number), "unshare", "--uts",
               "sh",         "-c",      fmt::format("hostname {} && exec \"$0\" \"$@\"", host(number))} +
         words;
}

std::set<std::string> names_in(const fs::path& folder, const std::string& beginning) {
  std::set<std::string> names;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder, missing))
    if (const std::string name = entry.path().filename(); name.starts_with(beginning)) names.insert(name);
  return names;
}

class FourHosts : public clients::CommandTest {
 protected:
  void SetUp() override {
    if (const std::string& obstacle = Network::shared()->obstacle(); !obstacle.empty())
      GTEST_SKIP() << obstacle;
    if (const std::string lacking = clients::missing({clients::Need::engine, clients::Need::mpi});
        !lacking.empty())
      GTEST_SKIP() << lacking;
    fs::create_directory(file("tmp"));
    std::ofstream hostfile(file("hosts"));
    for (int number = 1; number <= all_hosts; ++number) hostfile << host(number) << " slots=1\n";
  }

  /// A viewer on the first host, with nodes on all of them.
  clients::Command on_four_hosts(const Words& options, const Words& viewer) const {
    return command_of(on_host(1, clients::under(Words{"--hostfile", file("hosts")} + options) + viewer),
                      {{"OMPI_MCA_plm_rsh_agent", HOSTS_FOLDER "/launch_agent.sh"}});
  }

  std::uint64_t bytes_sent_by(int number) const {
    return std::stoull(run_well(on_host(number, {"cat", "/sys/class/net/eth0/statistics/tx_bytes"})).out);
  }

  void set_link(int number, const std::string& state) const {
    run_well({"ip", "link", "set", fmt::format("port{}", number), state});
  }

  /// How many images the nodes have drawn, counted in the folder of `--save-frames`.
  std::size_t drawn_by_nodes(const std::string& folder) const {
    std::error_code not_yet;
    const auto all = fs::directory_iterator(file(folder), not_yet);
    return std::size_t(std::count_if(begin(all), end(all), [](const auto& entry) {
      const std::string name = entry.path().filename();
      return name.ends_with(".pfm") && name.find("alpha") == std::string::npos;
    }));
  }

  std::string left_behind() const {
    std::string left = leftovers();
    for (const std::string& name : names_in(file("tmp"), "")) left += name + "\n";
    for (const std::string& name : names_in("/dev/shm", "")) left += "/dev/shm/" + name + "\n";
    for (const std::string& name : names_in("/run/netns", ""))
      if (!name.starts_with("host")) left += "namespace " + name + "\n";
    return left;
  }

  /// The PSNR of the worst frame of a turning viewer under Understudy, against the viewer alone.
  double worst_of(const std::string& bare, const std::string& under, int frames) const {
    double worst = HUGE_VAL;
    for (int number = 0; number < frames; ++number)
      worst =
          std::min(worst, viewer_test::difference(png(fmt::format("{}/frame_{:04}.png", bare, number % turn)),
                                                  png(fmt::format("{}/frame_{:04}.png", under, number)))
                              .psnr);
    return worst;
  }
};

int count_of(const std::string& text, const std::string& wanted) {
  int count = 0;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) count += line.find(wanted) != std::string::npos;
  return count;
}

/// Who drew the frames, 'n' for nodes, 'v' for the viewer, with the number of frames in a row: "n4 v30 n7".
std::string who_drew(const nlohmann::json& report) {
  std::string text;
  char who = 0;
  int in_a_row = 0;
  const auto tell = [&] {
    if (in_a_row > 0) text += fmt::format("{}{}{}", text.empty() ? "" : " ", who, in_a_row);
  };
  for (const auto& frame : report.at("frames_detail")) {
    const char now = frame.at("substituted") > 0 ? 'n' : 'v';
    if (now != who) {
      tell();
      in_a_row = 0;
    }
    who = now;
    ++in_a_row;
  }
  tell();
  return text;
}

TEST_F(FourHosts, GiveTheImageOfOneMachineOverTheNetwork) {
  const Words viewer = clients::engine_viewer("table", Words{"--frames", "4"} + turning);
  run_well(clients::under({"-n", "4", "--save-frames", file("one")}) + viewer);

  std::uint64_t sent_before = 0;
  for (int number = 1; number <= all_hosts; ++number) sent_before += bytes_sent_by(number);
  Child child(on_four_hosts({"--save-frames", file("four"), "--report", file("report.json")}, viewer),
              file(""));
  const Outcome outcome = child.finish();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::uint64_t sent = 0;
  for (int number = 1; number <= all_hosts; ++number) sent += bytes_sent_by(number);
  sent -= sent_before;

  double largest = 0;
  for (int number = 0; number < 4; ++number) {
    const std::string name = fmt::format("frame_{:04}.pfm", number);
    largest = std::max(largest,
                       understudy::launcher::difference(understudy::launcher::read_image(file("one") / name),
                                                        understudy::launcher::read_image(file("four") / name))
                           .max);
  }
  const nlohmann::json report = json("report.json");
  const auto exchanged = report.at("exchanged").at("bytes").get<std::uint64_t>();
  // Three of four ranks are on other hosts, and so are about three quarters of the engine's texels.
  const std::uint64_t texels = fs::file_size(clients::engine_file()) / 2;
  fmt::print(
      "4 ranks on 4 hosts: at most {:.2g} from 4 on one; {} bytes sent, of them {} between parts of images\n",
      largest, sent, exchanged);
  EXPECT_LE(largest, 1e-5);
  EXPECT_EQ(report.at("nodes"), 4);
  EXPECT_EQ(report.at("frames_substituted"), 4);
  EXPECT_EQ(report.at("frames_left"), 0);
  EXPECT_GT(exchanged, 0U);
  EXPECT_GE(sent, exchanged + texels);
  EXPECT_EQ(left_behind(), "");
}

/// Runs a turning viewer on four hosts, does `harm` after its third frame, and checks what follows: the viewer
/// must go on by itself, and then with `nodes_after` nodes again.
class Harmed : public FourHosts {
 protected:
  Outcome after(const std::function<void(Child&)>& harm, std::size_t nodes_after) {
    fs::create_directories(file("bare"));
    fs::create_directories(file("under"));
    run_well(clients::engine_viewer(
        "table", Words{"--frames", std::to_string(turn), "--screenshot-frames", file("bare")} + turning));
    Child child(on_four_hosts({"--report", file("report.json"), "--save-frames", file("nodes")},
                              clients::engine_viewer("table", Words{"--frames", "100000", "--print-times",
                                                                    "--screenshot-frames", file("under")} +
                                                                  turning)),
                file(""));
    const auto until = [&](const std::function<bool()>& condition) {
      return comes_true([&] { return !child.running() || condition(); }) && child.running();
    };
    const auto says = [&](const std::string& words) { return child.err().find(words) != std::string::npos; };
    EXPECT_TRUE(until([&] { return child.out().find("frame 2:") != std::string::npos; })) << child.err();
    const std::vector<pid_t> before = processes("understudy-node");
    EXPECT_EQ(before.size(), std::size_t(all_hosts));
    // The viewer saves frames until it is ended: without all hosts there is nothing to wait for.
    if (HasFailure()) return {-1, child.out(), child.err()};
    harm(child);
    EXPECT_TRUE(until([&] { return says("the render nodes are gone"); })) << child.err();
    const std::size_t drawn = drawn_by_nodes("nodes");
    EXPECT_TRUE(until([&] { return drawn_by_nodes("nodes") > drawn + 2; })) << child.err();
    EXPECT_TRUE(comes_true([&] { return processes("understudy-node").size() == nodes_after; }));
    for (const pid_t pid : processes("understudy-node")) EXPECT_EQ(std::ranges::count(before, pid), 0);
    child.signal(SIGTERM);
    Outcome outcome = child.finish();
    EXPECT_EQ(outcome.status, 128 + SIGTERM) << outcome.err;

    const std::string drew = who_drew(json("report.json"));
    // The last frame may be incomplete.
    const int frames = int(names_in(file("under"), "frame_").size()) - 1;
    const double worst = worst_of("bare", "under", frames);
    fmt::print("worst of {} frames PSNR {:.2f} dB, drawn by nodes (n) and the viewer (v): {}\n{}", frames,
               worst, drew, outcome.err);
    EXPECT_GE(worst, 40);
    EXPECT_THAT(drew, testing::MatchesRegex("n[0-9]+ v[0-9]+.* n[0-9]+"));
    EXPECT_EQ(count_of(outcome.err, "the render nodes are gone"), 1) << outcome.err;
    EXPECT_EQ(left_behind(), "");
    return outcome;
  }
};

TEST_F(Harmed, GoOnWithoutAHostThatIsCutOff) {
  const Outcome outcome = after([&](Child&) { set_link(3, "down"); }, all_hosts - 1);
  EXPECT_EQ(count_of(outcome.err, "the connection to host3 was lost"), 1) << outcome.err;
  EXPECT_EQ(count_of(outcome.err, "host host3 does not answer"), 1) << outcome.err;
  EXPECT_EQ(count_of(outcome.err, "continuing with 3 nodes on host1, host2, host4"), 1) << outcome.err;
  set_link(3, "up");
}

TEST_F(Harmed, StartAgainWhenARankStandsStillForGood) {
  const Outcome outcome = after(
      [&](Child&) {
        for (const pid_t pid : processes("understudy-node"))
          if (contents(fmt::format("/proc/{}/environ", pid))
                  .find(std::string("OMPI_COMM_WORLD_RANK=2") + '\0') != std::string::npos)
            kill(pid, SIGSTOP);
      },
      all_hosts);
  EXPECT_EQ(count_of(outcome.err, "they hang: a request is not done"), 1) << outcome.err;
}

}  // namespace
}  // namespace hosts

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  std::string obstacle;
  if (!GTEST_FLAG_GET(list_tests)) obstacle = hosts::enter_own_namespaces();
  testing::AddGlobalTestEnvironment(new hosts::Network(obstacle));
  return RUN_ALL_TESTS();
}
