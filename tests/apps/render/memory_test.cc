// SPDX-License-Identifier: Apache-2.0
// Volumes that do not fit into the ranks' memory: rendered in parts, they give the same image within the given
// memory.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

using ::testing::HasSubstr;

TEST_F(Render, ShowsInPartsWhatMemoryDoesNotHold) {
  const std::string scene = "synthetic:300x300x300:u16:gyroid --transfer-function ct --size 160x120 --report " +
                            folder_.file("r.json");
  const RgbaImage whole = image(scene);
  ASSERT_EQ(report()["passes"]["parts"], 1);
  const std::uint64_t whole_bytes = report()["ranks"][0]["peak_bytes"];
  for (const char* nodes : {"",
#ifdef UNDERSTUDY_HAS_NODES
                            " -n 2"
#endif
       }) {
    const RgbaImage parts = image(scene + " --memory 100M" + nodes);
    const Json figures = report();
    EXPECT_GT(figures["passes"]["parts"], 1) << nodes;
    EXPECT_GE(figures["passes"]["loads"], figures["passes"]["parts"]) << "no raw file tells its values";
    for (const Json& rank : figures["ranks"]) {
      const std::uint64_t peak = rank["peak_bytes"];
      std::printf("%s: %d parts, peak of a rank %llu MiB, of the whole %llu MiB\n", nodes,
                  figures["passes"]["parts"].get<int>(), static_cast<unsigned long long>(peak >> 20U),
                  static_cast<unsigned long long>(whole_bytes >> 20U));
      EXPECT_LE(double(peak), 1.1 * (100U << 20U));
    }
    EXPECT_LE(difference(whole, parts).max, 1e-5);
  }
}

TEST_F(Render, LeavesOutPartsThatShowNothing) {
  const std::string scene = "synthetic:200x200x200:u8:shells --size 90x90 --memory 60M --transfer-function " +
                            folder_.write("outside.json", R"({"positions": "values", "knots": [
                              {"at": 300, "colour": [1, 1, 1], "opacity": 0},
                              {"at": 400, "colour": [1, 1, 1], "opacity": 1}]})") +
                            " --report " + folder_.file("r.json");
  const Result result = render(scene);
  ASSERT_EQ(result.status, 0) << result.output;
  const Json passes = report()["passes"];
  ASSERT_GT(passes["parts"], 1);
  EXPECT_EQ(passes["empty"], passes["parts"]);
  EXPECT_EQ(passes["loads"], passes["parts"]) << "for their values, and not again";
  EXPECT_THAT(result.output, HasSubstr("parts without anything visible"));
}

#ifdef UNDERSTUDY_HAS_NODES
TEST_F(Render, NoRankKeepsAVolumeForTheOthersBeyondItsMemory) {
  // Half of the volume fits into each rank, the whole into none.
  const std::string scene = "synthetic:260x260x260:u16:gyroid --transfer-function ct --size 100x80 --report " +
                            folder_.file("r.json");
  const RgbaImage whole = image(scene + " -n 2");
  const RgbaImage halves = image(scene + " -n 2 --memory 110M");
  const Json figures = report();
  EXPECT_EQ(figures["passes"]["parts"], 1);
  for (const Json& rank : figures["ranks"]) {
    std::printf("%llu MiB\n", static_cast<unsigned long long>(rank["peak_bytes"].get<std::uint64_t>() >> 20U));
    EXPECT_LE(rank["peak_bytes"].get<double>(), 1.1 * (110U << 20U));
  }
  EXPECT_LE(difference(whole, halves).max, 1e-5);
}
#endif

TEST_F(Render, StaysWithinTheAddressesThatAProcessMayHave) {
  // Loaded as a whole, the volume would exceed the limit.
  const std::string scene =
      "synthetic:460x460x460:u16:gyroid --transfer-function ct --size 64x48 --report " + folder_.file("r.json");
  const Result result = shell("ulimit -v 1250000; " + std::string(UNDERSTUDY_PROGRAM) + " render --out " +
                              folder_.file("p.png") + " " + scene);
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_GT(report()["passes"]["parts"], 1);
}

TEST_F(Render, KeepsAnErrorInPartsAsInOne) {
  const std::string scene =
      "synthetic:120x120x120:u16:lobes --transfer-function vessels --size 96x80 --report " +
      folder_.file("r.json");
  const RgbaImage exact = image(scene + " --step 0.03");
  for (const char* memory : {"", " --memory 109M"}) {
    const RgbaImage shown = image(scene + " --error 2/255" + memory);
    const Json figures = report();
    EXPECT_EQ(figures["passes"]["parts"] > 1, *memory != '\0');
    if (*memory != '\0') {
      EXPECT_LE(figures["ranks"][0]["peak_bytes"].get<double>(), 1.1 * (109U << 20U));
    }
    ASSERT_TRUE(figures["budget"].is_object());
    // Per part: one load for the values, two for calibration, two for each check, and one for the image.
    EXPECT_LE(figures["passes"]["loads"], 10 * figures["passes"]["parts"].get<int>());
    EXPECT_LE(figures["budget"]["measured"], 2 / 255.0);
    const double apart = difference(exact, shown).max;
    std::printf("%d parts: asked %.4f, measured %.4f, all pixels %.4f, %s\n",
                figures["passes"]["parts"].get<int>(), 2 / 255.0, figures["budget"]["measured"].get<double>(),
                apart, figures["budget"]["setting"].get<std::string>().c_str());
    EXPECT_LE(apart, 2 / 255.0);
    EXPECT_LE(figures["image"]["step"], 1) << "whole voxels are not fine enough here";
  }
}

TEST_F(Render, ABudgetNeedsAnIntegral) {
  const Result light = render("synthetic:32x32x32 --size 32x32 --light all --error 0.01");
  EXPECT_EQ(light.status, 1);
  EXPECT_THAT(light.output, HasSubstr("no integral is defined for surfaces and light"));
  const Result both = render("synthetic:32x32x32 --size 32x32 --step 2 --error 0.01");
  EXPECT_EQ(both.status, 2);
}

TEST_F(Render, SaysWhatMemoryIsTooLittle) {
  Result result = render("synthetic:64x64x64 --memory 20M");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("less than a rank takes without a volume"));
  result = render("synthetic:64x64x64 --size 16x16 --memory 42150000");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("no part of this volume fits"));
  result = render("synthetic:64x64x64 --memory 2Q");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("is not a size"));
}

}  // namespace
}  // namespace understudy::launcher
