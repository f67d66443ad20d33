// SPDX-License-Identifier: Apache-2.0
// OpenGL as piglit's tests see it is the same bare and under Understudy, whatever the chain.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

namespace fs = std::filesystem;

/// For one run over all tests; on two cores it takes less than one minute.
constexpr std::chrono::minutes patience_with_piglit{12};

/// A line for each test that comes out otherwise, as the script prints it; docs/conformance.md gives the
/// reasons.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<std::string> known_remote_differences() {
  std::ifstream in(fs::path(SOURCE_FOLDER) / "tests/piglit/remote_differences.txt");
  return lines_of({std::istreambuf_iterator<char>(in), {}});
}

class Piglit : public CommandTest {
 protected:
  /// Why piglit cannot be run here; empty where it can.
  std::string lacking() const {
    if (!fs::exists(script))
      return "the list of piglit's tests is not here: it stands beside the project, as " +
             script.lexically_normal().string();
    return missing({Need::piglit, Need::x_server});
  }

  /// Runs all tests, with `before` in front of piglit, and leaves the results in a folder of that name.
  void run_all(const std::string& results, const std::string& before, const std::string& chain) const {
    const auto jobs = std::to_string(std::max(2U, std::thread::hardware_concurrency()));
    const std::string with = with_more_time.string() + " " + before;
    Child piglit(command_of({script.string(), file(results).string()},
                            {{"WITH", with}, {"UNDERSTUDY_CHAIN", chain}, {"JOBS", jobs}}),
                 file(""));
    const Outcome outcome = piglit.finish(patience_with_piglit);
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  }

  const fs::path script = fs::path(SOURCE_FOLDER) / "../shared/clients/piglit";
  const fs::path with_more_time = fs::path(SOURCE_FOLDER) / "tests/piglit/with_more_time";
};

class PiglitUnder : public Piglit, public testing::WithParamInterface<const char*> {};

TEST_P(PiglitUnder, ItsChainSeesTheSameOpenGl) {
  if (const std::string reason = lacking(); !reason.empty()) GTEST_SKIP() << reason;
  run_all("bare", "", "");
  const fs::path report = file("report.json");
  std::string launcher;
  for (const std::string& word : under({"--report", report.string()})) launcher += word + " ";
  ASSERT_NO_FATAL_FAILURE(run_all("under", launcher, GetParam()));

  const Outcome comparison = run({script.string(), "--diff", file("bare").string(), file("under").string()});
  EXPECT_EQ(comparison.status, 0) << comparison.out << comparison.err;
  EXPECT_THAT(comparison.out, testing::IsEmpty()) << "the status of a test alone, and under Understudy";

  const nlohmann::json processes = json("report.json").at("processes");
  const auto counted =
      std::count_if(processes.begin(), processes.end(), [](const auto& p) { return p.at("calls") > 0; });
  fmt::print("{} processes with calls\n", counted);
  EXPECT_GT(counted, 500) << "piglit did not run under Understudy";
}

INSTANTIATE_TEST_SUITE_P(TheDefaultChain, PiglitUnder, testing::Values(""),
                         [](const auto&) { return "Whole"; });
INSTANTIATE_TEST_SUITE_P(ALongChain, PiglitUnder,
                         testing::Values("pass pass pass track volume driver",
                                         "pack unpack track volume driver"),
                         [](const auto& info) { return info.index == 0 ? "OfPasses" : "OfAStream"; });

TEST_F(Piglit, SeesTheOpenGlOfAStageButForWhatIsListed) {
  if (const std::string reason = lacking(); !reason.empty()) GTEST_SKIP() << reason;
  run_all("bare", "", "");
  const std::vector<std::string> known = known_remote_differences();
  ASSERT_FALSE(known.empty());
  // One process draws; or two, each its tile of every window.
  for (const std::string chain : {"", "track volume tiles(of=2) driver"}) {
    SCOPED_TRACE(chain.empty() ? "the default chain" : chain);
    const std::string results = chain.empty() ? "remote" : "tiles";
    std::string launcher;
    for (const std::string& word : under({"--remote"})) launcher += word + " ";
    ASSERT_NO_FATAL_FAILURE(run_all(results, launcher, chain));
    const Outcome comparison = run({script.string(), "--diff", file("bare").string(), file(results).string()});
    ASSERT_LE(comparison.status, 1) << comparison.out << comparison.err;
    std::size_t differences = 0;
    for (const std::string& line : lines_of(comparison.out)) {
      ++differences;
      EXPECT_THAT(known, testing::Contains(line)) << "is listed in no line of remote_differences.txt";
    }
    fmt::print("{}: {} of 7,275 differ\n", results, differences);
  }
}

}  // namespace
}  // namespace clients
