// SPDX-License-Identifier: Apache-2.0
// `understudy study` as seen by its user: errors are reported, measurements are kept, the page is displayed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "apps/understudy/images/image.h"
#include "apps/understudy/study/measure.h"
#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class StudyCommand : public ::testing::Test {
 protected:
  std::string command(const std::string& arguments) const {
    return std::string(UNDERSTUDY_PROGRAM) + " study --alone --out " + folder_.file("out") + " " + arguments;
  }
  Result study(const std::string& arguments) const { return shell(command(arguments)); }
  std::string trouble(const std::string& arguments) const {
    const Result result = study(arguments);
    EXPECT_NE(result.status, 0) << arguments;
    return result.output;
  }
  std::vector<std::string> rows() const {
    std::ifstream csv(folder_.file("out/study.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(csv, line);) lines.push_back(line);
    if (!lines.empty()) lines.erase(lines.begin());
    return lines;
  }
  std::string volume(const std::string& name, char value) const {
    return folder_.write(name + "_9x8x7_u8.raw", std::string(9 * 8 * 7, value));
  }
  std::string table(const std::string& control_points) const {
    return volume("some", 'x') + "," + folder_.write("t.json", control_points) + " --scene thin-fog --size 8";
  }

  TemporaryFolder folder_;
};

/// The row without its last column (whether the setting is on the front), which further points may change.
std::string key_and_figures(const std::string& row) {
  return row.substr(0, row.rfind(','));
}

TEST_F(StudyCommand, WhatIsWrongIsSaidWithTheNextStep) {
  EXPECT_THAT(trouble("--scene nothing"), AllOf(HasSubstr("no scene 'nothing'"), HasSubstr("thin-fog")));
  EXPECT_THAT(shell(UNDERSTUDY_PROGRAM " study --alone --scene thin-fog --out /proc/nothing").output,
              AllOf(HasSubstr("/proc/nothing"), HasSubstr("--out")));
  EXPECT_THAT(trouble("--scene thin-fog --volume " + folder_.file("no_8x8x8_u8.raw")),
              HasSubstr("check the path"));
  EXPECT_THAT(trouble("--scene thin-fog --size 8 --volume " +
                      folder_.write("short_9x9x9_u8.raw", std::string(70, 'x'))),
              HasSubstr("truncated"));
  EXPECT_THAT(trouble("--scene thin-fog --size 8 --volume synthetic:8x8"), HasSubstr("synthetic:512x512x512"));
  EXPECT_THAT(trouble("--scene thin-fog --volume " + volume("some", 'x') + ",nothing"),
              HasSubstr("grey, engine"));
  EXPECT_THAT(trouble("--size 0"), HasSubstr("--size"));
}

TEST_F(StudyCommand, ATableThatIsNoneIsRefused) {
  EXPECT_THAT(trouble("--volume " + table("{")), HasSubstr("not a transfer function"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": []})")), HasSubstr("too few"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("too few"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 1, "colour": [0,0,0], "opacity": 0},
                                                          {"at": 0, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("sort them"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": -0.1},
                                                          {"at": 1, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("opacity is -0.1"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": NaN},
                                                          {"at": 1, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("not a transfer function"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 0, "colour": [0,0,2], "opacity": 0},
                                                          {"at": 1, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("a component of 2"));
  EXPECT_THAT(trouble("--volume " + table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": 0},
                                                          {"at": 1e999, "colour": [0,0,0], "opacity": 0.5}]})")),
              HasSubstr("not a transfer function"));
}

TEST_F(StudyCommand, AVolumeOfWhichNothingShowsIsRefused) {
  const std::string clear =
      folder_.write("clear.json", R"({"knots": [{"at": 0, "colour": [1,1,1], "opacity": 0},
                                                                      {"at": 1, "colour": [1,1,1], "opacity": 0}]})");
  EXPECT_THAT(trouble("--scene thin-fog --size 8 --volume " + volume("some", 'x') + "," + clear),
              AllOf(HasSubstr("nothing of"), HasSubstr("another table")));
}

TEST_F(StudyCommand, AVolumeOfOneValueIsMeasured) {
  const std::string fog = folder_.write("fog.json", R"({"knots": [{"at": 0, "colour": [1,1,1], "opacity": 0.1},
                                                                  {"at": 1, "colour": [1,1,1], "opacity": 0.1}]})");
  study("--quick --size 12 --scene thin-fog --volume " + volume("even", 'x') + "," + fog);
  EXPECT_EQ(rows().size(), 2 * (study::settings(true).size() - 3)) << "all but other programs, in two scenes";
}

TEST_F(StudyCommand, GoesOnWhereItWasKilled) {
  const std::string all = command("--scene thin-fog --size 96");
  // Killed after some settings have been measured, without an opportunity to clean up.
  shell("(exec " + all + ") & pid=$!; until [ \"$(cat " + folder_.file("out/study.csv") +
        " 2>/dev/null | wc -l)\" -ge 4 ]; do kill -0 $pid || break; done; kill -9 $pid; wait $pid");
  const std::vector<std::string> before = rows();
  ASSERT_GE(before.size(), 3U);
  study("--scene thin-fog --size 96");
  const std::vector<std::string> after = rows();
  std::printf("%zu rows when it was killed, %zu in the end\n", before.size(), after.size());
  EXPECT_EQ(after.size(), study::settings(false).size() - 3);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(key_and_figures(after[i]), key_and_figures(before[i]));
  std::set<std::string> settings;
  for (const std::string& row : after) {
    std::size_t end = 0;
    for (int field = 0; field < 4; ++field) end = row.find(',', end) + 1;
    EXPECT_TRUE(settings.insert(row.substr(0, end)).second) << row << " is there twice";
  }
  // When repeated, nothing is measured again.
  study("--scene thin-fog --size 96");
  EXPECT_EQ(rows(), after);
}

TEST_F(StudyCommand, ThePageShowsInABrowser) {
  for (const char* needed : {"command -v chromium", "/usr/bin/python3 -c 'import matplotlib'"})
    if (shell(needed).status != 0)
      GTEST_SKIP() << "apt install chromium python3-matplotlib: '" << needed << "' fails";
  ASSERT_EQ(study("--quick --size 48 --scene thin-fog --scene spikes").status, 0);
  const std::string screenshot = folder_.file("page.png");
  const Result shown =
      shell("timeout 120 chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir=" +
            folder_.file("profile") + " --window-size=1300,3000 --screenshot=" + screenshot + " file://" +
            folder_.file("out/index.html"));
  ASSERT_EQ(shown.status, 0) << shown.output;
  const RgbaImage page = read_image(screenshot);
  EXPECT_EQ(page.width, 1300);
  // Text is dark, the plots' lines are blue and orange: there must be many pixels of each.
  std::array<int, 3> pixels{};
  const auto near_colour = [](const float* pixel, const std::array<int, 3>& bytes) {
    return std::ranges::equal(std::span(pixel, 3), bytes,
                              [](float a, int b) { return std::abs(a - float(b) / 255) < 0.05F; });
  };
  constexpr std::array<std::array<int, 3>, 3> colours{{{0, 0, 0}, {31, 119, 180}, {255, 127, 14}}};
  for (int y = 0; y < page.height; ++y)
    for (int x = 0; x < page.width; ++x)
      for (std::size_t k = 0; k < 3; ++k) pixels[k] += near_colour(page.pixel(x, y), colours[k]) ? 1 : 0;
  std::printf("%d pixels of text and frames, %d blue, %d orange\n", pixels[0], pixels[1], pixels[2]);
  for (const int count : pixels) EXPECT_GT(count, 500);
}

}  // namespace
}  // namespace understudy::launcher
