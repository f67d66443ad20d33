// SPDX-License-Identifier: Apache-2.0
// Draws every scenario bare, under Understudy and, if the images differ, bare in floats, which shows how far
// they may differ. Is what Understudy shows right, and is it substituted or left as the scenario's file states?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/adversary/command.h"
#include "tests/adversary/verdict.h"

namespace adversary {
namespace {

namespace fs = std::filesystem;

constexpr int frames = 30;

/// Pixels along both edges of the window: fewer than in `./run test --full`, which draws for three times as
/// long.
std::string pixels_of_an_edge() {
  const char* const asked = std::getenv("ADVERSARY_EDGE");
  return asked != nullptr ? asked : "128";
}

std::string contents(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Scenarios that are not met yet, with the reason.
const std::map<std::string, std::string>& known_misses() {
  static const std::map<std::string, std::string> misses = [] {
    std::map<std::string, std::string> read;
    std::ifstream file(ADVERSARY_KNOWN_MISSES);
    for (std::string line; std::getline(file, line);) {
      const std::size_t colon = line.find(": ");
      if (!line.starts_with('#') && colon != std::string::npos)
        read[line.substr(0, colon)] = line.substr(colon + 2);
    }
    return read;
  }();
  return misses;
}

class Adversary : public testing::TestWithParam<NamedScenario> {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  /// Runs `adversary run` into the folder `into`, with `before` in front of the command and `after` behind it.
  void draw(const std::string& into, std::vector<std::string> before = {},
            const std::vector<std::string>& after = {}) {
    before.insert(before.end(), {ADVERSARY_PROGRAM, "run", GetParam().name, (folder_ / into).string(),
                                 "--frames", std::to_string(frames), "--edge", pixels_of_an_edge()});
    before.insert(before.end(), after.begin(), after.end());
    const fs::path log = folder_ / (into + ".log");
    // Otherwise a viewer that is faster natively would not be substituted, and nothing would be tested.
    ASSERT_EQ(run_command(before, log, {"UNDERSTUDY_SPEED_GUARD=off"}), 0) << contents(log);
  }

  const fs::path folder_ = fs::path(ADVERSARY_FOLDER) / GetParam().name;
};

TEST_P(Adversary, ShowsNoWrongImage) {
  ASSERT_NO_FATAL_FAILURE(draw("bare"));
  EXPECT_EQ(contents(folder_ / "bare" / "facts.txt").find("OpenGL error"), std::string::npos);
  ASSERT_NO_FATAL_FAILURE(
      draw("under", {UNDERSTUDY_PROGRAM, "run", "--report", (folder_ / "report.json").string(), "--"}));
  const Verdict verdict = judge_drawing_exactly_where_needed(
      folder_, frames, [this] { ASSERT_NO_FATAL_FAILURE(draw("exact", {}, {"--exact"})); });
  ASSERT_FALSE(HasFatalFailure());
  fmt::print("adversary: {}\n{}", line_about(GetParam(), verdict), contents(folder_ / "under.log"));
  const std::string not_met = what_is_not_met(GetParam().scenario, verdict);
  if (known_misses().contains(GetParam().name + " at " + pixels_of_an_edge())) {
    EXPECT_NE(not_met, "") << "it is met now: take it out of known_misses.txt";
  } else {
    EXPECT_EQ(not_met, "") << "images are in " << folder_;
  }
  if (!HasFailure() && !keeps_images()) fs::remove_all(folder_);
}

/// Returns the scenarios that full_only.txt names, or the others.
std::vector<NamedScenario> scenarios(bool full_only) {
  std::set<std::string> named;
  std::ifstream file(ADVERSARY_FULL_ONLY);
  for (std::string line; std::getline(file, line);) named.insert(line);
  std::vector<NamedScenario> all = all_scenarios();
  std::erase_if(all, [&](const NamedScenario& one) { return named.contains(one.name) != full_only; });
  return all;
}

std::string name_of(const testing::TestParamInfo<NamedScenario>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Of, Adversary, testing::ValuesIn(scenarios(false)), name_of);
INSTANTIATE_TEST_SUITE_P(FullOnly, Adversary, testing::ValuesIn(scenarios(true)), name_of);

}  // namespace
}  // namespace adversary
