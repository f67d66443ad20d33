// SPDX-License-Identifier: Apache-2.0
// A rank is killed while a viewer draws frames: the frames must not show any difference.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

constexpr int lost_node_frames = 20;
constexpr int ranks = 3;

class LostNode : public CommandTest, public testing::WithParamInterface<int> {
 protected:
  /// Process id of a rank; 0 if there is none.
  pid_t rank(int number) const {
    for (const pid_t pid : processes("understudy-node")) {
      const std::string environment = contents(fmt::format("/proc/{}/environ", pid));
      if (environment.find(fmt::format("OMPI_COMM_WORLD_RANK={}", number) + '\0') != std::string::npos)
        return pid;
    }
    return 0;
  }

  /// Whether rank 0 of a group has connected to the launcher's socket. The stopped viewer, which connects from
  /// time to time, may hold connections of its own.
  bool group_is_there(pid_t viewer) const {
    std::set<std::string> of_viewer;
    std::error_code gone;
    for (const auto& entry : std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", viewer), gone))
      of_viewer.insert(std::filesystem::read_symlink(entry.path(), gone).string());
    std::istringstream sockets(contents("/proc/net/unix"));
    const std::string path = runtime_.string();
    int at_launcher = 0;
    int viewers_own = 0;
    // Columns: address, references, protocol, flags, type, state (03: connected), inode, path of the accepting
    // end.
    for (std::string line; std::getline(sockets, line);) {
      if (line.find(" 0001 03 ") == std::string::npos) continue;
      at_launcher += line.find(path) != std::string::npos;
      std::istringstream columns(line.substr(line.find(" 0001 03 ") + 9));
      std::string inode;
      columns >> inode;
      viewers_own += of_viewer.contains(fmt::format("socket:[{}]", inode));
    }
    return at_launcher > viewers_own && processes("understudy-node").size() == ranks;
  }
};

std::vector<std::string> lines_with(const std::string& text, const std::string& wanted) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.find(wanted) != std::string::npos) found.push_back(line);
  return found;
}

TEST_P(LostNode, TheViewerGoesOnAndAnotherGroupTakesOver) {
  if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  const auto viewer = [&](const std::filesystem::path& images) {
    return engine_viewer("table", {"--frames", std::to_string(lost_node_frames), "--orbit", "3",
                                   "--print-times", "--screenshot-frames", images.string()});
  };
  run_well(viewer(file("bare")));

  Child child(
      command_of(under({"-n", std::to_string(ranks), "--report", file("report.json")}) + viewer(file("under"))),
      file(""));
  const auto frame_is_out = [&](int number) {
    return comes_true([&] {
      return !child.running() || child.out().find(fmt::format("frame {}:", number)) != std::string::npos;
    });
  };
  ASSERT_TRUE(frame_is_out(2) && child.running()) << child.err();
  const pid_t killed = rank(GetParam());
  ASSERT_NE(killed, 0);
  ASSERT_EQ(kill(killed, SIGKILL), 0);

  // The viewer draws faster than a group starts, so it is stopped at its seventh frame until the next group
  // exists.
  ASSERT_TRUE(frame_is_out(6) && child.running()) << child.err();
  const std::vector<pid_t> viewers = processes("understudy-viewer");
  ASSERT_EQ(viewers.size(), 1U);
  kill(viewers.front(), SIGSTOP);
  const bool another_group = comes_true([&] {
    const pid_t now = rank(GetParam());
    return now != 0 && now != killed && group_is_there(viewers.front());
  });
  kill(viewers.front(), SIGCONT);
  const Outcome outcome = child.finish();
  EXPECT_TRUE(another_group) << outcome.err;
  EXPECT_EQ(outcome.status, 0) << outcome.err;

  double worst = HUGE_VAL;
  for (int number = 0; number < lost_node_frames; ++number) {
    const std::string name = fmt::format("frame_{:04}.png", number);
    worst = std::min(worst, viewer_test::difference(png("bare/" + name), png("under/" + name)).psnr);
  }
  std::string who_drew;
  const nlohmann::json report = json("report.json");
  for (const auto& frame : report.at("frames_detail"))
    who_drew += frame.at("substituted") > 0 ? 'n' : frame.at("left") > 0 ? 'v' : '-';
  fmt::print(
      "rank {} of {} killed after the third frame: worst of {} frames PSNR {:.2f} dB, drawn by nodes (n) and "
      "the "
      "viewer (v): {}\n{}",
      GetParam(), ranks, lost_node_frames, worst, who_drew, outcome.err);
  EXPECT_GE(worst, 40);
  EXPECT_EQ(who_drew.substr(0, 3), "nnn");
  EXPECT_TRUE(who_drew.ends_with("n")) << "the next group has taken over";

  std::vector<std::string> told = lines_with(outcome.err, "render nodes");
  std::erase_if(told, [](const std::string& line) { return line.find(" seen, ") != std::string::npos; });
  EXPECT_EQ(told.size(), 1U) << "one line says what happened:\n" << outcome.err;
  EXPECT_EQ(leftovers(), "");
}

INSTANTIATE_TEST_SUITE_P(Rank, LostNode, testing::Values(0, 2),
                         [](const auto& info) { return std::to_string(info.param); });

}  // namespace
}  // namespace clients
