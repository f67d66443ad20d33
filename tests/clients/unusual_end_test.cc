// SPDX-License-Identifier: Apache-2.0
// Viewers that end without closing what they opened: their exit status is passed on, and no node, socket or
// folder remains.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

class UnusualEnd : public CommandTest {
 protected:
  void SetUp() override {
    if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty())
      GTEST_SKIP() << lacking;
  }

  Words on_two_ranks() const { return under({"-n", "2", "--report", file("report.json")}); }
};

TEST_F(UnusualEnd, AViewerThatLeavesInTheMidstOfAFrame) {
  for (const std::string way : {"_exit", "exit"}) {
    const Outcome outcome = run(on_two_ranks() + Words{"env", "LD_PRELOAD=" LEAVES_EARLY, "LEAVE_BY=" + way} +
                                engine_viewer("table", {"--frames", "20"}));
    fmt::print("{}: status {}\n{}", way, outcome.status, outcome.err);
    EXPECT_EQ(outcome.status, 5) << outcome.err;
    const nlohmann::json report = json("report.json");
    EXPECT_EQ(report.at("nodes"), 2);
    EXPECT_GE(report.at("frames_substituted"), 2) << "a viewer's figures outlive it";
    EXPECT_EQ(leftovers(), "");
  }
}

TEST_F(UnusualEnd, AViewerThatIsKilled) {
  for (const int signal : {SIGKILL, SIGSEGV}) {
    Child child(command_of(on_two_ranks() + engine_viewer("table", {"--frames", "100000", "--print-times"})),
                file(""));
    ASSERT_TRUE(
        comes_true([&] { return !child.running() || child.out().find("frame 3:") != std::string::npos; }));
    ASSERT_TRUE(child.running()) << child.err();
    const std::vector<pid_t> viewers = processes("understudy-viewer");
    ASSERT_EQ(viewers.size(), 1U);
    kill(viewers.front(), signal);
    const Outcome outcome = child.finish();
    fmt::print("signal {}: status {}\n{}", signal, outcome.status, outcome.err);
    EXPECT_EQ(outcome.status, 128 + signal) << outcome.err;
    EXPECT_GE(json("report.json").at("frames_substituted"), 3);
    EXPECT_EQ(leftovers(), "");
  }
}

TEST_F(UnusualEnd, ALauncherThatIsKilledTakesNodesAndViewerWithItAndTheNextOneCleansUp) {
  Child child(command_of(on_two_ranks() + engine_viewer("table", {"--frames", "100000", "--print-times"})),
              file(""));
  ASSERT_TRUE(
      comes_true([&] { return !child.running() || child.out().find("frame 3:") != std::string::npos; }));
  ASSERT_TRUE(child.running()) << child.err();
  child.signal(SIGKILL);
  child.finish();
  EXPECT_TRUE(comes_true([&] { return processes().empty(); })) << leftovers();
  // A young folder of a run is not removed, because its owner may be about to lock it.
  EXPECT_TRUE(comes_true([&] {
    run(under({}) + Words{"true"});
    return std::filesystem::is_empty(runtime_);
  })) << leftovers();
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace clients
