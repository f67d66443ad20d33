// SPDX-License-Identifier: Apache-2.0
// The folder of a run is private, and removed at the end.
#include "apps/understudy/launch/run_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;

TEST(RunFolder, IsForItsOwnerAloneAndRemovedWithAllItHolds) {
  fs::path path;
  {
    const RunFolder folder;
    path = folder.path();
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0700U);
    fs::create_directory(path / "inside");
    std::ofstream(path / "inside" / "file") << "x";
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(RunFolder, LeavesTheFolderOfAnotherRunAlone) {
  const RunFolder first;
  const RunFolder second;
  EXPECT_NE(first.path(), second.path());
  EXPECT_TRUE(fs::exists(first.path()));
}

TEST(RunFolder, RemovesWhatADeadLauncherLeftAndNoFolderOfTheUsers) {
  std::string parent = (fs::temp_directory_path() / "folders-test-XXXXXX").string();
  ASSERT_NE(mkdtemp(parent.data()), nullptr);
  setenv("XDG_RUNTIME_DIR", parent.c_str(), 1);
  const fs::path own = fs::path(parent) / "understudy-run-tables";
  fs::create_directory(own);
  fs::permissions(own, fs::perms::owner_all);
  std::ofstream(own / "table.csv") << "1";
  const pid_t launcher = fork();
  if (launcher == 0) {
    new RunFolder();
    _exit(0);
  }
  ASSERT_EQ(waitpid(launcher, nullptr, 0), launcher);
  const auto folders = [&] { return std::distance(fs::directory_iterator(parent), fs::directory_iterator()); };
  EXPECT_EQ(folders(), 2);
  std::this_thread::sleep_for(std::chrono::seconds(12));  // younger folders are not removed
  { const RunFolder next; }
  EXPECT_EQ(folders(), 1);
  EXPECT_TRUE(fs::exists(own / "table.csv"));
  fs::remove_all(parent);
}

}  // namespace
}  // namespace understudy::launcher
