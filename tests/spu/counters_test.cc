// SPDX-License-Identifier: Apache-2.0
// Volume counters of a process that has had more volumes than counter slots, and counters of forked children.
#include "spu/report/counters.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "spu/report/report.h"

namespace understudy::spu {
namespace {

std::uint64_t runs_left() {
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : process_counters().volume) sum += volume.draws_left;
  return sum;
}

std::uint64_t reasons_counted() {
  std::uint64_t sum = 0;
  for (const VolumeCounters& volume : process_counters().volume)
    for (const ReasonCount& reason : volume.left_because) sum += reason.count;
  return sum;
}

VolumeCounters& new_volume_that_is_left(int texture) {
  VolumeCounters& volume = count_volume(std::uint64_t(texture));
  volume.draws_left.fetch_add(1);
  count_reason(volume, "reason of " + std::to_string(texture));
  return volume;
}

TEST(VolumesPlaces, GoToNewVolumesWhenTheOldOnesAreGone) {
  const std::uint64_t before = runs_left();
  for (int texture = 1; texture <= 100; ++texture) {
    VolumeCounters& volume = new_volume_that_is_left(texture);
    EXPECT_NE(&volume, &process_counters().volume[max_counted_volumes - 1]);
    EXPECT_EQ(volume.texture, std::uint64_t(texture));
    EXPECT_EQ(volume.draws_left, 1U);
    EXPECT_EQ(volume.left_because[0].reason, "reason of " + std::to_string(texture));
    leave_behind(volume);
  }
  EXPECT_EQ(runs_left(), before + 100) << "the figures of volumes that are gone still count";
  EXPECT_EQ(reasons_counted(), runs_left());
}

TEST(VolumesPlaces, OfMoreVolumesThanThereArePlacesAreShared) {
  std::vector<VolumeCounters*> living;
  for (int texture = 1; texture <= 2 * max_counted_volumes; ++texture)
    living.push_back(&new_volume_that_is_left(texture));
  const VolumeCounters& last = process_counters().volume[max_counted_volumes - 1];
  EXPECT_EQ(living.back(), &last);
  EXPECT_EQ(std::string(last.left_because[max_counted_reasons - 1].reason), "other reasons");
  EXPECT_EQ(reasons_counted(), runs_left());
  for (VolumeCounters* volume : living) leave_behind(*volume);
  EXPECT_NE(&count_volume(1), &last) << "there are places again";
}

TEST(CountersOfAForkedChild, HaveAFileOnlyIfTheyAreUsed) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(::testing::TempDir()) / ("counters-of-children-" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::uint64_t* const calls = thread_call_counter();
  const auto in_child = [&](auto work) {
    const pid_t child = fork();
    if (child == 0) {
      setenv("UNDERSTUDY_RUN_DIR", folder.c_str(), 1);
      work();
      _exit(0);
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  };
  in_child([] {});
  EXPECT_TRUE(fs::is_empty(folder));
  in_child([&] {
    *calls += 3;  // a thread keeps this pointer
    count_frame({.time_ms = 1, .error_rms = -1});
  });
  in_child([] { *thread_call_counter() += 1; });
  const auto found = read_counters(folder);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]->frames + found[1]->frames, 1U);
  std::uint64_t calls_in_all = 0;
  for (const MappedCounters& counters : found)
    calls_in_all += std::accumulate(std::begin(counters->calls), std::end(counters->calls), std::uint64_t(0));
  EXPECT_EQ(calls_in_all, 4U);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace understudy::spu
