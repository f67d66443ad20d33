// SPDX-License-Identifier: Apache-2.0
// `understudy render` with volumes larger than the memory that OpenGL may use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Render, ShowsTheSameFromLittleGpuMemory) {
  const std::string common = "synthetic:140x130x150:u8:lobes --size 60x50 -n 2 --backend gl";
  const Result probe = render(common);
  ASSERT_EQ(probe.status, 0) << probe.output;
  if (probe.output.find("GL, as asked") == std::string::npos) GTEST_SKIP() << probe.output;
  EXPECT_THAT(probe.output, Not(HasSubstr("by bricks")));
  const RgbaImage all = image(common);
  // Memory for three or more bricks of 65^3 16-bit texels, while each node has twelve or eighteen bricks.
  const std::string little = common + " --gpu-memory 2200K --report " + folder_.file("r.json");
  EXPECT_LE(difference(image(little), all).max, 1e-5);
  EXPECT_THAT(report()["backends"].dump(),
              AllOf(HasSubstr("node 0: GL draws volume"), HasSubstr("node 1: GL draws volume"),
                    HasSubstr("of which 4 of")));
}

TEST_F(Render, SaysHowMuchGpuMemoryIsNeeded) {
  const auto trouble = [&](const std::string& options) {
    const Result result = render("synthetic:20x20x20 --size 20x20 -n 1 " + options);
    EXPECT_NE(result.status, 0) << options;
    return result.output;
  };
  EXPECT_THAT(trouble("--backend gl --gpu-memory 1M"),
              AllOf(HasSubstr("too little"), HasSubstr("2197000"), HasSubstr("at least 3M")));
  EXPECT_THAT(trouble("--backend gl --gpu-memory much"), HasSubstr("K, M, G or T, or auto"));
  EXPECT_THAT(trouble("--backend gl --gpu-memory 5MB"), HasSubstr("K, M, G or T, or auto"));
  EXPECT_THAT(trouble("--backend gl --gpu-memory 99999999999T"), HasSubstr("99999999999T is too large"));
  EXPECT_THAT(trouble("--gpu-memory 1G"), HasSubstr("--backend"));
}

}  // namespace
}  // namespace understudy::launcher
