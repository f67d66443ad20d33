// SPDX-License-Identifier: Apache-2.0
// Two viewers at once on the nodes of one `understudy serve`.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

namespace fs = std::filesystem;

class SharedNodes : public CommandTest {
 protected:
  void SetUp() override {
    if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty())
      GTEST_SKIP() << lacking;
  }

  /// A screenshot that is complete, because a later frame has followed.
  fs::path frame(const std::string& folder, int number) const {
    return file(folder) / fmt::format("frame_{:04}.png", number);
  }
  int frames_written(const std::string& folder) const {
    int count = 0;
    while (fs::exists(frame(folder, count))) ++count;
    return count;
  }
};

TEST_F(SharedNodes, ServeTwoViewersAtTheSameTime) {
  const Words first_viewer = engine_viewer("table", {});
  const Words second_viewer = engine_viewer("core", {"--azimuth", "70", "--preset", "bone"});
  run_well(first_viewer + Words{"--screenshot", file("first_bare.png")});
  run_well(second_viewer + Words{"--screenshot", file("second_bare.png")});

  const std::string socket = file("nodes.sock");
  Child nodes(command_of({(programs / "understudy").string(), "serve", "-n", "2", "--socket", socket}),
              file(""));
  ASSERT_TRUE(
      comes_true([&] { return !nodes.running() || nodes.out().find("2 nodes at") != std::string::npos; }));
  ASSERT_TRUE(nodes.running()) << nodes.err();

  // The first viewer draws from before the second one starts until after it has ended.
  fs::create_directory(file("first"));
  Child first(command_of(under({"--connect", socket, "--report", file("first.json")}) + first_viewer +
                         Words{"--frames", "100000", "--screenshot-frames", file("first")}),
              file(""));
  const auto first_draws = [&](int frames) {
    return comes_true([&] { return !first.running() || frames_written("first") > frames; }) && first.running();
  };
  ASSERT_TRUE(first_draws(2)) << first.err();
  const int before = frames_written("first");
  run_well(under({"--connect", socket, "--report", file("second.json")}) + second_viewer +
           Words{"--frames", "6", "--screenshot", file("second.png")});
  const int during = frames_written("first");
  ASSERT_TRUE(first_draws(during + 2)) << first.err();
  fmt::print("the first drew {} frames before, {} while the second drew its 6\n", before, during - before);

  first.signal(SIGTERM);
  EXPECT_EQ(first.finish().status, 128 + SIGTERM);
  for (const std::string viewer : {"first", "second"}) {
    const nlohmann::json report = json(viewer + ".json");
    EXPECT_EQ(report.at("nodes"), 2) << viewer;
    EXPECT_GE(report.at("frames_substituted"), 6) << viewer;
    EXPECT_EQ(report.at("frames_left"), 0) << viewer;
  }
  fs::copy_file(frame("first", before), file("first.png"));
  EXPECT_GE(told("the first, bare and beside another", png("first_bare.png"), png("first.png")).psnr, 40);
  EXPECT_GE(told("the second, bare and beside another", png("second_bare.png"), png("second.png")).psnr, 40);

  nodes.signal(SIGTERM);
  EXPECT_EQ(nodes.finish().status, 0);
  EXPECT_EQ(nodes.err().find("dropped"), std::string::npos) << nodes.err();
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace clients
