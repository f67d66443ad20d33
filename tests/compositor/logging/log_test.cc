// SPDX-License-Identifier: Apache-2.0
// Log lines on stderr, in separate processes, because the environment is read only once.
#include "compositor/logging/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace understudy::logging {
namespace {

void write_one_of_each() {
  log(Level::debug, "{} texels", 8);
  log(Level::info, "{} exists", "a.ust");
  log(Level::warn, "no nodes; {}", "drawing here");
  log(Level::error, "no driver");
}

[[noreturn]] void write_at_level(const char* level) {
  ::setenv("UNDERSTUDY_LOG", level, 1);
  write_one_of_each();
  std::exit(0);
}

class Logging : public ::testing::Test {
 protected:
  Logging() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

const std::string with_info =
    "understudy: a.ust exists\nunderstudy: no nodes; drawing here\nunderstudy: no driver\n";

std::string only(const std::string& lines) {
  return "^" + lines + "$";
}

TEST_F(Logging, UsuallyAllButDebugLinesAreWritten) {
  EXPECT_EXIT(write_at_level(""), ::testing::ExitedWithCode(0), only(with_info));
  EXPECT_EXIT(write_at_level("info"), ::testing::ExitedWithCode(0), only(with_info));
}

TEST_F(Logging, DebugLinesSaySo) {
  EXPECT_EXIT(write_at_level("debug"), ::testing::ExitedWithCode(0),
              only("understudy: debug: 8 texels\n" + with_info));
}

TEST_F(Logging, LowerLevelsAreLeftOut) {
  EXPECT_EXIT(write_at_level("warn"), ::testing::ExitedWithCode(0),
              only("understudy: no nodes; drawing here\nunderstudy: no driver\n"));
  EXPECT_EXIT(write_at_level("error"), ::testing::ExitedWithCode(0), only("understudy: no driver\n"));
}

TEST_F(Logging, AnUnknownLevelIsNamedOnce) {
  EXPECT_EXIT(
      write_at_level("loud"), ::testing::ExitedWithCode(0),
      only("understudy: UNDERSTUDY_LOG=loud is none of debug, info, warn and error; using info\n" + with_info));
}

TEST_F(Logging, AnotherProgramWritesItsOwnName) {
  EXPECT_EXIT(
      {
        set_program("understudy-node");
        write_at_level("error");
      },
      ::testing::ExitedWithCode(0), only("understudy-node: no driver\n"));
}

}  // namespace
}  // namespace understudy::logging
