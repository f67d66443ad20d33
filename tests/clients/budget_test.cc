// SPDX-License-Identifier: Apache-2.0
// A viewer under `understudy run --error E`: what it shows keeps the error, as measured by a test program that
// uses only the viewer's description and the volume file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

struct Volume {
  const char* name;
  const char* file;  ///< in the folder of data volumes; empty: the engine
  Words options;
};

std::filesystem::path path_of(const Volume& volume) {
  if (*volume.file == '\0') return engine_file();
  return std::filesystem::path(SOURCE_FOLDER) / "../shared/data" / volume.file;
}

class BudgetRun : public CommandTest {
 protected:
  /// Draws eight frames with a budget; returns false if the volume file is missing.
  bool show(const Volume& volume, const Words& budget) {
    const std::filesystem::path path = path_of(volume);
    if (!std::filesystem::exists(path)) return false;
    const Words viewer = {programs / "understudy-viewer",
                          path,
                          "--mode",
                          "core",
                          "--offscreen",
                          "--window-size",
                          "200",
                          "200",
                          "--frames",
                          "8",
                          "--no-frame",
                          "--describe",
                          file("frame.json"),
                          "--screenshot",
                          file("under.png")};
    outcome = run_well(under(budget + Words{"--report", file("report.json"), "--save-frames", file("frames")}) +
                       viewer + volume.options);
    report = json("report.json");
    return true;
  }
  nlohmann::json recomputed(const Volume& volume) {
    const Outcome judged =
        run_well({ERROR_OF_FRAME, file("frame.json"), file("frames") / "frame_0007.pfm", path_of(volume), "4"});
    return nlohmann::json::parse(judged.out);
  }

  Outcome outcome;
  nlohmann::json report;
};

const std::array volumes{
    Volume{"engine", "", {}}, Volume{"aneurism", "aneurism_256x256x256_uint8.raw.gz", {}},
    Volume{
        "cthead", "cthead_256x256x113_int16be.raw.gz", {"--type", "i16", "--big-endian", "--preset", "bone"}}};
const std::array errors{"8/255", "2/255", "0.5/255"};

class ErrorBudget : public BudgetRun, public testing::WithParamInterface<std::tuple<int, int>> {};

TEST_P(ErrorBudget, IsKept) {
  const auto [volume, error] = GetParam();
  if (!show(volumes[std::size_t(volume)], {"--error", errors[std::size_t(error)]}))
    GTEST_SKIP() << "no such file";
  ASSERT_EQ(report.at("frames_substituted"), 8) << outcome.err;
  const nlohmann::json& budget = report.at("volumes").at(0).at("budget");
  const nlohmann::json judged = recomputed(volumes[std::size_t(volume)]);
  const double asked = budget.at("asked"), measured = budget.at("measured");
  fmt::print(
      "{}, error asked {:.4f}, measured {:.4f}, recomputed over {} pixels {:.4f} (RMS {:.1e}); {:.1f} ms: {}\n",
      volumes[std::size_t(volume)].name, asked, measured, judged.at("pixels").get<int>(),
      judged.at("max").get<double>(), judged.at("rms").get<double>(), budget.at("time_ms").get<double>(),
      budget.at("setting").get<std::string>());
  EXPECT_LE(judged.at("max"), asked);
  EXPECT_LE(measured, asked);
  EXPECT_GT(measured, 0);
  EXPECT_GT(judged.at("opacity"), 0.3) << "there is something to see";
  EXPECT_EQ(budget.at("note"), "");
  EXPECT_NE(outcome.err.find(fmt::format("error asked {:.4f}, measured", asked)), std::string::npos)
      << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(Volumes, ErrorBudget, testing::Combine(testing::Range(0, 3), testing::Range(0, 3)),
                         [](const auto& info) {
                           return fmt::format("{}_{}", volumes[std::size_t(std::get<0>(info.param))].name,
                                              std::get<1>(info.param));
                         });

class Budgets : public BudgetRun {};

TEST_F(Budgets, AreKeptByRanksToo) {
  if (const std::string lacking = missing({Need::engine, Need::mpi}); !lacking.empty()) GTEST_SKIP() << lacking;
  ASSERT_TRUE(show(volumes[0], {"-n", "3", "--error", "2/255"}));
  EXPECT_EQ(report.at("nodes"), 3);
  const nlohmann::json& budget = report.at("volumes").at(0).at("budget");
  EXPECT_LE(recomputed(volumes[0]).at("max"), budget.at("asked")) << budget.dump();
  EXPECT_GT(budget.at("measured"), 0);
}

TEST_F(Budgets, OfTimeAreReportedWithTheirError) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  ASSERT_TRUE(show(volumes[0], {"--time", "1s"}));
  const nlohmann::json& budget = report.at("volumes").at(0).at("budget");
  EXPECT_TRUE(budget.at("asked").is_null());
  EXPECT_EQ(budget.at("asked_ms"), 1000);
  EXPECT_GT(budget.at("measured"), 0);
  EXPECT_NE(outcome.err.find("time asked 1000 ms, taken"), std::string::npos) << outcome.err;
}

TEST_F(Budgets, ThatCannotBeKeptSayTheBestThereIs) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  ASSERT_TRUE(show(volumes[0], {"--error", "1e-9"}));
  EXPECT_EQ(report.at("frames_substituted"), 8);
  EXPECT_NE(outcome.err.find("cannot be kept"), std::string::npos) << outcome.err;
}

TEST_F(Budgets, AreLeftAloneWhereTexelsAreColours) {
  if (const std::string lacking = missing({Need::engine}); !lacking.empty()) GTEST_SKIP() << lacking;
  run_well(under({"--error", "0.01", "--report", file("report.json")}) +
           engine_viewer("rgba", {"--no-frame", "--frames", "2", "--screenshot", file("under.png")}));
  const nlohmann::json budget = json("report.json").at("volumes").at(0).at("budget");
  EXPECT_TRUE(budget.at("measured").is_null());
  EXPECT_NE(budget.at("note").get<std::string>().find("colours already"), std::string::npos) << budget.dump();
  EXPECT_EQ(substituted(json("report.json")), 2);
}

TEST_F(Budgets, ThatAreNoneAreRefused) {
  for (const char* const error : {"0", "10", "abc", "1/0", "nan", "-1", "2/1", ""}) {
    const Outcome refused = run(under({"--error", error}) + Words{"true"});
    EXPECT_EQ(refused.status, 2) << error;
    EXPECT_NE(refused.err.find("above 0 and at most 1"), std::string::npos) << refused.err;
  }
  for (const char* const time : {"0", "-3ms", "3 hours", "1e9", "90s"}) {
    const Outcome refused = run(under({"--time", time}) + Words{"true"});
    EXPECT_EQ(refused.status, 2) << time;
    EXPECT_NE(refused.err.find("above 0 and at most a minute"), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace clients
