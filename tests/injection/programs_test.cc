// SPDX-License-Identifier: Apache-2.0
// Programs that use EGL's OpenGL in unusual ways.
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/injection/under_injection.h"

namespace {

using namespace understudy::testing;

constexpr double good_psnr = 40;

/// Mesa's other software renderer, which still draws after main has ended.
const Words softpipe{"GALLIUM_DRIVER=softpipe"};

class Programs : public UnderInjection {};

TEST_P(Programs, EglGetProcAddressForAllCalls) {
  EXPECT_GT(expect_same({client("oddities"), "by_address"}).total().calls, 2U);
}

TEST_P(Programs, PythonWithCtypes) {
  if (std::string(PYTHON).empty()) GTEST_SKIP() << "no Python here";
  for (const Words& libraries :
       {Words{"libGL.so.1"}, Words{"find", "find"}, Words{"libOpenGL.so.0", "libEGL.so.1"}}) {
    Words command{PYTHON, PYTHON_CLIENT};
    command.insert(command.end(), libraries.begin(), libraries.end());
    const CountedRun run = expect_same(command);
    EXPECT_EQ(run.outcome.text, "64 128 191 255 0x0\n");
    EXPECT_GT(run.total().calls, 3U);
  }
}

TEST_P(Programs, ForkBeforeAContextExists) {
  for (const char* scene : {"before_context", "before_context_but_after_a_call"}) {
    const CountedRun run = expect_same({client("forks"), scene});
    ASSERT_EQ(run.processes.size(), 2U) << "each counts for itself";
    EXPECT_EQ(run.processes[0].calls, run.processes[1].calls) << "they draw the same number of images";
    EXPECT_GT(run.processes[0].calls, 50U);
    EXPECT_EQ(run.processes[0].frames, 1U);
  }
}

TEST_P(Programs, ForkWithAContextAndTheChildOnlyLeaves) {
  for (const char* scene : {"child_only_exits", "child_leaves_at_once"}) {
    const CountedRun run = expect_same({client("forks"), scene});
    ASSERT_EQ(run.processes.size(), 1U) << "a child that counts nothing leaves no file";
    EXPECT_GT(run.processes[0].calls, 100U);
  }
}

TEST_P(Programs, ForkWithAContextAndTheChildDraws) {
  const CountedRun anew = expect_same({client("forks"), "child_draws_anew"});
  const CountedRun goes_on = expect_same({client("forks"), "child_goes_on"}, {"LP_NUM_THREADS=0"});
  // The child's calls go to the driver only; the parent's counters are separate.
  EXPECT_EQ(anew.total().calls, goes_on.total().calls);
  EXPECT_EQ(anew.total().frames, 1U);
}

TEST_P(Programs, AChildThatOutlivesItsParentLeavesTheReportAlone) {
  Words environment = environment_of(GetParam());
  environment.push_back("LIBGL_ALWAYS_SOFTWARE=1");
  environment.push_back("UNDERSTUDY_REPORT=" + file("report.json"));
  const Outcome outcome = run_program(environment, {client("forks"), "child_outlives_parent"});
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  std::ifstream report(file("report.json"));
  EXPECT_GT(nlohmann::json::parse(report).at("processes").at(0).at("calls"), 30) << "the parent's";
}

TEST_P(Programs, TwoThreadsWithContextsOfTheirOwn) {
  for (const char* scene : {"apart", "shared"}) {
    EXPECT_GT(expect_same({client("threads"), scene}).total().calls, 10000U) << scene;
  }
}

TEST_P(Programs, TwoThreadsThatDrawVolumes) {
  for (const char* scene : {"volumes", "shared_volume"}) {
    run_behind(InjectionMethod::none, {client("threads"), scene, file("bare")});
    const CountedRun behind = run_behind(GetParam(), {client("threads"), scene, file("behind")});
    EXPECT_EQ(behind.outcome.status, 0) << behind.outcome.text;
    EXPECT_EQ(behind.outcome.text, "done\n");
    EXPECT_EQ(behind.total().substituted, 12U) << scene;
    const double psnr = psnr_of_files(file("bare"), file("behind"));
    std::printf("%s: %.1f dB\n", scene, psnr);
    EXPECT_GT(psnr, good_psnr);
  }
}

TEST_P(Programs, OpenGlBeforeAndAfterMain) {
  for (const char* context : {"destroyed", "current"}) {
    EXPECT_GT(expect_same({client("around_main"), context}, softpipe).total().calls, 50U) << context;
  }
}

std::string without_our_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("understudy:")) rest += line + "\n";
  }
  return rest;
}

// The ray caster's resources are released by then.
TEST_P(Programs, AVolumeAfterMainIsLeftToTheProgram) {
  const Words command{client("around_main"), "current", "volume"};
  const CountedRun bare = run_behind(InjectionMethod::none, command, softpipe);
  const CountedRun behind = run_behind(GetParam(), command, softpipe);
  EXPECT_EQ(behind.outcome.status, 0) << behind.outcome.text;
  EXPECT_TRUE(behind.outcome.says("not substituted: the program is ending")) << behind.outcome.text;
  EXPECT_EQ(behind.total().substituted, 2U) << "those of main";
  EXPECT_EQ(without_our_lines(behind.outcome.text), without_our_lines(bare.outcome.text));
}

TEST_P(Programs, CallsWithoutAContext) {
  expect_same({client("oddities"), "no_context"});
}

TEST_P(Programs, AThreadThatEndsWithItsContextCurrent) {
  EXPECT_GT(expect_same({client("oddities"), "thread_ends_with_context"}).total().calls, 200U);
}

UNDER_EVERY_METHOD(Programs);

}  // namespace
