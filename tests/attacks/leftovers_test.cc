// SPDX-License-Identifier: Apache-2.0
// A node group whose mpirun is killed: the memory that its ranks shared is removed with the run, at the latest
// when the next group starts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/attacks/server.h"
#include "tests/clients/command_test.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;

class Leftovers : public clients::CommandTest {
 protected:
  /// Number of files through which ranks share memory.
  std::ptrdiff_t segments() const {
    std::error_code gone;
    std::ptrdiff_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(runtime_, gone))
      count += entry.path().filename().string().starts_with("vader_segment");
    return count;
  }
};

TEST_F(Leftovers, OfAKilledMpirunAreNone) {
  {
    Server server(file(""), {}, 2);
    ASSERT_TRUE(clients::comes_true([&] { return segments() == 2; })) << "not in the run's folder";
    for (const pid_t process : processes("mpirun")) ::kill(process, SIGKILL);
    EXPECT_TRUE(clients::comes_true([&] {
      return server.process().err().find("(attempt 1 of 5)") != std::string::npos && segments() == 2;
    })) << server.process().err();
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().finish().status, 0);
  }
  EXPECT_EQ(leftovers(), "");
}

}  // namespace
}  // namespace attacks
