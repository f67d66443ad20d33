// SPDX-License-Identifier: Apache-2.0
// A process that never has a context does not open the core library, but still appears in the launcher's
// report.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "run_program.h"
#include "spu/report/counters.h"

namespace {

namespace fs = std::filesystem;
using understudy::spu::ProcessCounters;
using understudy::testing::run_program;

class ContextlessCalls : public testing::Test {
 protected:
  ContextlessCalls() {
    std::string pattern = (fs::temp_directory_path() / "contextless-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ContextlessCalls() override { fs::remove_all(folder_); }

  void play(const std::string& scene) const {
    run_program({"LD_LIBRARY_PATH=" TEST_STAGE "/entry", "UNDERSTUDY_DRIVER_DIR=" TEST_DRIVER,
                 "UNDERSTUDY_RUN_DIR=" + folder_.string()},
                {TEST_CLIENTS "/glx_client", scene});
  }

  /// The bytes of every file in the folder.
  std::vector<std::string> left() const {
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      std::ifstream stream(entry.path(), std::ios::binary);
      files.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
    return files;
  }

  fs::path folder_;
};

TEST_F(ContextlessCalls, AreLeftForTheLauncher) {
  play("never_current");
  const auto files = left();
  ASSERT_EQ(files.size(), 1U);
  ASSERT_EQ(files[0].size(), sizeof(ProcessCounters));
  const auto counters = std::make_unique<ProcessCounters>();
  std::memcpy(static_cast<void*>(counters.get()), files[0].data(), files[0].size());
  EXPECT_EQ(counters->magic, understudy::spu::counters_magic);
  EXPECT_GT(counters->pid, 0);
  EXPECT_TRUE(std::string(counters->program).ends_with("/glx_client")) << counters->program;
  EXPECT_EQ(counters->calls[0], 2U) << "a context made, and destroyed";
  EXPECT_EQ(counters->frames, 0U);
}

TEST_F(ContextlessCalls, AreTheCoresAffairWhenThereIsOne) {
  play("one_frame");
  EXPECT_TRUE(left().empty()) << "the test's core keeps no counters";
}

}  // namespace
