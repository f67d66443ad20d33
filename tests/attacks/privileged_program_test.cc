// SPDX-License-Identifier: Apache-2.0
// A program with more privileges than its user must not load a driver named in the environment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/clients/command_test.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

using PrivilegedProgram = CommandTest;

TEST_F(PrivilegedProgram, LoadsNoDriverThatTheEnvironmentNames) {
  const std::map<std::string, std::string> environment{{"UNDERSTUDY_DRIVER_DIR", FOREIGN_DRIVERS}};
  const fs::path copy = file("copy");
  fs::copy_file(PRIVILEGED, copy);
  // The variable names the driver's folder: without extra privileges, the driver is loaded.
  EXPECT_THAT(run({copy.string()}, environment).out, HasSubstr("foreign code runs"));

  constexpr gid_t other_group = 65534;
  if (::chown(copy.c_str(), ::getuid(), other_group) != 0 || ::chmod(copy.c_str(), 02755) != 0)
    GTEST_SKIP() << "only root can make a program that has another group's rights";
  const Outcome outcome = run({copy.string()}, environment);
  if (outcome.out.find("secure 1") == std::string::npos)
    GTEST_SKIP() << "programs in this folder get no rights of others: " << outcome.out;
  EXPECT_EQ(outcome.status, 0) << outcome.out;
  EXPECT_THAT(outcome.out, Not(HasSubstr("foreign code runs")));
}

}  // namespace
}  // namespace clients
