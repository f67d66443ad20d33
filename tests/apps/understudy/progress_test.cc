// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/progress/progress.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <string>

namespace understudy::launcher {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

/// What is written to stderr for a hundred steps.
std::string progress_of(ProgressStyle style) {
  testing::internal::CaptureStderr();
  {
    Progress progress(style);
    for (int i = 0; i <= 100; ++i) progress.show(i / 100.0, fmt::format("cutting {:3} %", i));
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, LinesThatStayComeForEveryTenthAtLeast) {
  const std::string lines = progress_of(ProgressStyle::lines);
  EXPECT_THAT(lines, StartsWith("understudy: cutting   0 %\n"));
  EXPECT_THAT(lines, EndsWith("understudy: cutting 100 %\n"));
  // On a slow machine there is one more line every two seconds.
  EXPECT_GE(std::ranges::count(lines, '\n'), 11);
  EXPECT_EQ(lines.find('\r'), std::string::npos);
}

TEST(Progress, TheLineOfATerminalIsGoneInTheEnd) {
  const std::string line = progress_of(ProgressStyle::line);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_THAT(line, EndsWith("\runderstudy: cutting 100 %\033[K\r\033[K"));
}

TEST(Progress, SilenceIsSilent) {
  EXPECT_EQ(progress_of(ProgressStyle::silent), "");
}

}  // namespace
}  // namespace understudy::launcher
