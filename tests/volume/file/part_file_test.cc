// SPDX-License-Identifier: Apache-2.0
// A written file gets its name only when it is complete; a file that is never completed leaves nothing behind.
#include "volume/file/part_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "tests/volume/file/volume_files.h"

namespace understudy::volume::testing {
namespace {

std::ptrdiff_t files_in(const TemporaryFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.file("")), {});
}

bool files_need_no_name(const TemporaryFolder& folder) {
  const int descriptor = ::open(folder.file("").c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

TEST(PartFile, HasItsNameOnceItIsWhole) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", std::string("what was there before"));
  {
    PartFile file(path);
    file.append(std::as_bytes(std::span("12345", 5)));
    file.replace(1, std::as_bytes(std::span("x", 1)));
    EXPECT_EQ(std::filesystem::file_size(path), 21U);
    file.finish();
  }
  EXPECT_EQ(std::filesystem::file_size(path), 5U);
  EXPECT_EQ(files_in(folder), 1);
  for (const auto meanwhile : {PartFile::Meanwhile::nameless, PartFile::Meanwhile::named}) {
    PartFile file(folder.file("b"), meanwhile);
    file.append(std::as_bytes(std::span("12345", 5)));
    EXPECT_FALSE(std::filesystem::exists(folder.file("b")));
  }
  EXPECT_EQ(files_in(folder), 1) << "it never became whole";
  {
    PartFile file(folder.file("b"), PartFile::Meanwhile::named);
    file.append(std::as_bytes(std::span("12345", 5)));
    EXPECT_EQ(files_in(folder), 2);
    file.finish();
  }
  EXPECT_EQ(std::filesystem::file_size(folder.file("b")), 5U);
  EXPECT_EQ(files_in(folder), 2);
}

TEST(PartFile, OfAProcessThatIsKilledNothingIsLeft) {
  const TemporaryFolder folder;
  if (!files_need_no_name(folder)) GTEST_SKIP() << "this file system has no files without a name";
  const pid_t child = fork();
  if (child == 0) {
    PartFile file(folder.file("a"));
    file.append(std::vector<std::byte>(1 << 20));
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(files_in(folder), 0);
}

}  // namespace
}  // namespace understudy::volume::testing
