// SPDX-License-Identifier: Apache-2.0
// The folder of a run is private, and gone at the end.
#include "apps/understudy/launch/run_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

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

}  // namespace
}  // namespace understudy::launcher
