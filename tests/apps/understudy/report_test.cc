// SPDX-License-Identifier: Apache-2.0
// Counters outlive their process, and the report contains their values.
#include "spu/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace understudy::spu {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

/// A run of three frames: two substituted on four nodes and verified, one left for a reason.
std::unique_ptr<ProcessCounters> example() {
  auto counters = std::make_unique<ProcessCounters>();
  counters->magic = counters_magic;
  counters->pid = 4242;
  std::strcpy(counters->program, "/usr/bin/viewer");
  counters->frames = 3;
  counters->frames_substituted = 2;
  counters->frames_left = 1;
  counters->nodes = 4;
  counters->threads = 2;
  counters->calls[0] = 1000;
  counters->calls[1] = 234;
  counters->total.samples = 500;
  counters->total.samples_taken = 120;
  counters->total.blocks_empty = 9;
  counters->frame[0] = {.time_ms = 40, .substituted = 0, .left = 1, .error_rms = -1};
  counters->frame[1] = {.time_ms = 10,
                        .spent_ms = {.waiting = 0.5, .recognition = 1, .depth = 3, .render = 5},
                        .substituted = 1,
                        .left = 0,
                        .error_rms = 0.01};
  counters->frame[2] = {.time_ms = 20,
                        .spent_ms = {.waiting = 1.5, .recognition = 2, .depth = 4, .render = 6},
                        .substituted = 1,
                        .left = 0,
                        .error_rms = -1};
  counters->volumes = 1;
  VolumeCounters& volume = counters->volume[0];
  volume.texture = 7;
  volume.size[0] = 256;
  volume.size[1] = 128;
  volume.size[2] = 110;
  std::strcpy(volume.texture_format, "GL_INTENSITY8");
  volume.draws_substituted = 2;
  volume.draws_left = 1;
  std::strcpy(volume.left_because[0].reason, "classification depends on position (lighting)");
  volume.left_because[0].count = 1;
  volume.verified_frames = 4;
  volume.verify_max = 0.05;
  volume.verify_sum_sq = 4 * 0.01 * 0.01;
  return counters;
}

json report_of(const ProcessCounters& counters) {
  const ProcessCounters* const one = &counters;
  return json::parse(report_json(Processes(&one, 1)));
}

TEST(Report, HasEveryKeyThatReadersRelyOn) {
  const json report = report_of(*example());
  for (const char* key :
       {"frames", "nodes", "remote", "processes", "time_ms", "left_out", "frames_detail", "volumes"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["frames"], 3);
  EXPECT_EQ(report["nodes"], 4);
  EXPECT_EQ(report["remote"], false);
  EXPECT_EQ(report["processes"][0]["pid"], 4242);
  EXPECT_EQ(report["processes"][0]["program"], "/usr/bin/viewer");
  EXPECT_EQ(report["processes"][0]["calls"], 1234);
  EXPECT_EQ(report["time_ms"]["frame_median"], 20);
  EXPECT_EQ(report["time_ms"]["substituted_median"], 15);
  EXPECT_EQ(report["time_ms"]["application_median"], 40);
  EXPECT_EQ(report["time_ms"]["waiting_median"], 1) << "of substituted frames";
  EXPECT_EQ(report["time_ms"]["recognition_median"], 1.5) << "of substituted frames";
  EXPECT_EQ(report["time_ms"]["depth_median"], 3.5) << "of substituted frames";
  EXPECT_EQ(report["left_out"]["samples_skipped"], 380);
  EXPECT_EQ(report["left_out"]["blocks_empty"], 9);
  const json& volume = report["volumes"][0];
  EXPECT_EQ(volume["size"], json({256, 128, 110}));
  EXPECT_EQ(volume["texture_format"], "GL_INTENSITY8");
  EXPECT_EQ(volume["draws"]["substituted"], 2);
  EXPECT_EQ(volume["draws"]["left"], 1);
  EXPECT_EQ(volume["left_because"]["classification depends on position (lighting)"], 1);
  EXPECT_EQ(volume["verify"]["frames"], 4);
  EXPECT_EQ(volume["verify"]["max"], 0.05);
  EXPECT_NEAR(volume["verify"]["rms"].get<double>(), 0.01, 1e-12);
  EXPECT_NEAR(volume["verify"]["psnr"].get<double>(), 40.0, 1e-9);
}

TEST(Report, SaysForEveryFrameItsTimeItsErrorAndWhatWasLeftOut) {
  const json frames = report_of(*example())["frames_detail"];
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1]["time_ms"], 10);
  EXPECT_EQ(frames[1]["error_rms"], 0.01);
  EXPECT_TRUE(frames[0]["error_rms"].is_null());
  EXPECT_NE(frames[0]["setting"], frames[1]["setting"]);
  EXPECT_TRUE(frames[2]["left_out"].contains("samples_skipped"));
}

TEST(Report, SumsOverProcessesAndLeavesOutThoseThatDidNothing) {
  const auto first = example();
  const auto second = example();
  const auto idle = std::make_unique<ProcessCounters>();
  const std::array<const ProcessCounters*, 3> processes{first.get(), second.get(), idle.get()};
  const json report = json::parse(report_json(processes));
  EXPECT_EQ(report["frames"], 6);
  EXPECT_EQ(report["nodes"], 4);
  EXPECT_EQ(report["processes"].size(), 2U);
  EXPECT_EQ(report["volumes"].size(), 2U);
}

TEST(Report, OfARunWithoutFramesHasNoMedians) {
  const json report = json::parse(report_json({}));
  EXPECT_EQ(report["frames"], 0);
  EXPECT_TRUE(report["time_ms"]["frame_median"].is_null());
  EXPECT_TRUE(report["volumes"].empty());
}

TEST(Report, KeepsTheLastFramesOfALongRun) {
  const auto counters = example();
  counters->frames = max_frame_records + 10;
  const json frames = report_of(*counters)["frames_detail"];
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(max_frame_records));
  EXPECT_EQ(frames[0]["frame"], 10);
}

TEST(Report, BelievesNoCountThatExceedsItsTable) {
  const auto counters = example();
  counters->volumes = 4'000'000'000U;
  counters->threads = 4'000'000'000U;
  std::memset(counters->program, 'x', sizeof counters->program);
  std::memset(counters->volume[1].texture_format, '\xff', sizeof counters->volume[1].texture_format);
  EXPECT_EQ(report_of(*counters)["volumes"].size(), static_cast<std::size_t>(max_counted_volumes));
}

TEST(Report, SaysInOneLineWhatHappenedAndWhy) {
  const auto counters = example();
  const ProcessCounters* const one = counters.get();
  const std::string line = summary_line(Processes(&one, 1));
  EXPECT_EQ(line,
            "understudy: 1 volume seen, 3 frames: 2 substituted (4 nodes), 1 not substituted: "
            "classification depends on position (lighting)");
  EXPECT_THAT(explanation_text(Processes(&one, 1)), HasSubstr("256 x 128 x 110 GL_INTENSITY8"));
}

TEST(Report, NamesNobodyAsTheOneWhoDrewWhereNothingWasSubstituted) {
  const auto counters = example();
  counters->frames_substituted = 0;
  counters->frames_left = 3;
  counters->nodes = 0;  // `--connect` got no answer
  std::strcpy(counters->volume[0].left_because[0].reason, "the render nodes did not answer");
  counters->volume[0].left_because[0].count = 3;
  const ProcessCounters* const one = counters.get();
  EXPECT_EQ(summary_line(Processes(&one, 1)),
            "understudy: 1 volume seen, 3 frames: 0 substituted, 3 not substituted: "
            "the render nodes did not answer (3x)");
  counters->frames_substituted = 1;
  EXPECT_THAT(summary_line(Processes(&one, 1)), HasSubstr("1 substituted (embedded)"));
}

TEST(Report, CountsDrawsWhereNoFrameWasShown) {
  const auto counters = example();
  counters->frames = 0;
  counters->frames_substituted = 0;
  counters->frames_left = 0;
  counters->volume[0].draws_substituted = 16;
  counters->volume[0].draws_left = 1;
  const ProcessCounters* const one = counters.get();
  EXPECT_THAT(
      summary_line(Processes(&one, 1)),
      HasSubstr("1 volume seen, no frame shown, 17 draws: 16 substituted (4 nodes), 1 not substituted"));
  EXPECT_EQ(has_substituted(Processes(&one, 1)), true);
  counters->volume[0].draws_substituted = 0;
  EXPECT_EQ(has_substituted(Processes(&one, 1)), false);
}

TEST(Report, KnowsNothingOfFramesThatAStageElsewhereHasDrawnButTheirNumber) {
  const auto counters = std::make_unique<ProcessCounters>();
  counters->remote.is = 1;
  counters->remote.frames = 12;
  const ProcessCounters* const one = counters.get();
  EXPECT_EQ(summary_line(Processes(&one, 1)),
            "understudy: 12 frames came from a GL server on another machine, which knows what of them was "
            "substituted");
  // A window with a single buffer shows images without ending a frame.
  const auto server = std::make_unique<ProcessCounters>();
  server->calls[0] = 100;
  const std::array<const ProcessCounters*, 2> both = {counters.get(), server.get()};
  EXPECT_THAT(summary_line(both), HasSubstr("0 frames: 0 substituted"));
}

class CountersInAFolder : public ::testing::Test {
 protected:
  CountersInAFolder() {
    fs::create_directories(folder_);
    setenv("UNDERSTUDY_RUN_DIR", folder_.c_str(), 1);
  }
  ~CountersInAFolder() override {
    unsetenv("UNDERSTUDY_RUN_DIR");
    fs::remove_all(folder_);
  }

  /// Runs `work` in a child that ends without cleaning up, like a killed viewer.
  template <typename Work>
  static void in_killed_child(Work work) {
    const pid_t child = fork();
    if (child == 0) {
      work();
      raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
  }

  fs::path folder_ = fs::temp_directory_path() / ("understudy-counters-" + std::to_string(getpid()));
};

TEST_F(CountersInAFolder, OutliveAKilledProcess) {
  in_killed_child([] {
    ++*thread_call_counter();
    count_frame(
        {.time_ms = 5, .substituted = 1, .error_rms = -1, .counts = {.samples = 100, .samples_taken = 60}});
    count_frame({.time_ms = 6, .left = 1, .error_rms = -1});
  });
  const auto found = read_counters(folder_);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]->frames, 2U);
  EXPECT_EQ(found[0]->frames_substituted, 1U);
  EXPECT_EQ(found[0]->frames_left, 1U);
  EXPECT_EQ(found[0]->total.samples, 100U);
  EXPECT_EQ(found[0]->calls[0], 1U);
  EXPECT_THAT(std::string(found[0]->program), HasSubstr("report_test"));
}

TEST_F(CountersInAFolder, AChildAfterForkCountsForItself) {
  in_killed_child([] {
    ProcessCounters& counters = process_counters();
    std::uint64_t* calls = thread_call_counter();
    *calls = 10;
    if (const pid_t grandchild = fork(); grandchild == 0) {
      *calls += 3;  // the pointer that a thread keeps stays valid
      _exit(&process_counters() == &counters ? 0 : 1);
    } else {
      int status = 0;
      waitpid(grandchild, &status, 0);
      counters.frames = status == 0 ? 1 : 0;
    }
  });
  const auto found = read_counters(folder_);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]->calls[0] + found[1]->calls[0], 13U);
  EXPECT_EQ(found[0]->frames + found[1]->frames, 1U) << "the child keeps the parent's address";
}

TEST_F(CountersInAFolder, FilesThatAreNoCountersArePassedOver) {
  std::ofstream(folder_ / "1.counters") << "short";
  std::ofstream(folder_ / "2.counters") << std::string(2 * sizeof(ProcessCounters), 'x');
  std::ofstream(folder_ / "nodes.log") << std::string(2 * sizeof(ProcessCounters), 'x');
  EXPECT_TRUE(read_counters(folder_).empty());
  EXPECT_TRUE(read_counters(folder_ / "missing").empty());
}

TEST_F(CountersInAFolder, AFolderThatIsGoneCostsTheFiguresAndNothingElse) {
  fs::remove_all(folder_);
  in_killed_child([] { count_frame({.time_ms = 1}); });
}

TEST_F(CountersInAFolder, AReportIsReplacedWholeAndLeavesNothingBeside) {
  const fs::path path = folder_ / "report.json";
  in_killed_child([&] {
    write_report_when_due(path);
    count_frame({.time_ms = 1, .error_rms = -1});
    write_report_when_due(path);  // not due again yet
    if (json::parse(std::ifstream(path))["frames"] != 0) _exit(1);
    if (!write_report_now(path)) _exit(2);
  });
  EXPECT_EQ(json::parse(std::ifstream(path))["frames"], 1);
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST_F(CountersInAFolder, AReportThatCannotBeWrittenIsSaidOnce) {
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(write_report_now(folder_ / "missing" / "report.json"));
  EXPECT_FALSE(write_report_now(folder_ / "missing" / "report.json"));
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.find("cannot write the report"), said.rfind("cannot write the report")) << said;
  EXPECT_THAT(said, HasSubstr("missing/report.json"));
}

}  // namespace
}  // namespace understudy::spu
