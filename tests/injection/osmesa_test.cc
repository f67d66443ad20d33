// SPDX-License-Identifier: Apache-2.0
// Programs that use OSMesa, which is a separate OpenGL without a window system.
#include <cstdio>

#include "tests/injection/under_injection.h"

namespace {

using namespace understudy::testing;

/// Images may differ by the rounding of an 8-bit framebuffer.
constexpr double good_image = 40;

class OsMesa : public UnderInjection {};

TEST_P(OsMesa, DrawsTheSamePixels) {
  const CountedRun run = expect_same({client("osmesa")});
  EXPECT_GT(run.total().calls, 100U);
}

TEST_P(OsMesa, SwitchedOffDrawsTheSamePixels) {
  const std::vector<std::string> command{client("osmesa")};
  const std::string bare = run_behind(InjectionMethod::none, command).outcome.text;
  const CountedRun run = run_behind(GetParam(), command, {"UNDERSTUDY_DISABLE=1"});
  EXPECT_EQ(run.outcome.text, bare);
  EXPECT_TRUE(run.processes.empty());
}

TEST_P(OsMesa, AndEglInOneProgram) {
  EXPECT_GT(expect_same({client("osmesa_and_egl")}).total().calls, 200U);
  EXPECT_EQ(run_behind(GetParam(), {client("osmesa_and_egl")}, {"UNDERSTUDY_DISABLE=1"}).outcome.text,
            run_behind(InjectionMethod::none, {client("osmesa_and_egl")}).outcome.text);
}

TEST_P(OsMesa, AVolumeInSlicesIsSubstituted) {
  const CountedRun bare = run_behind(InjectionMethod::none, {client("osmesa"), file("bare")});
  const CountedRun behind = run_behind(GetParam(), {client("osmesa"), file("behind")});
  EXPECT_EQ(behind.outcome.text, bare.outcome.text);
  EXPECT_EQ(behind.total().substituted, 4U) << "one for each image that the program finished";
  const double psnr = psnr_of_files(file("bare"), file("behind"));
  std::printf("%.1f dB, %lu frames, %lu calls\n", psnr, behind.total().frames, behind.total().calls);
  EXPECT_GT(psnr, good_image);
}

TEST_P(OsMesa, TheDepthBufferThatItHandsOutHasTheSlicesDepth) {
  for (const char* how : {"depth", "depth_of_second"}) {
    const CountedRun bare = run_behind(InjectionMethod::none, {client("osmesa"), file("bare"), how});
    ASSERT_TRUE(bare.outcome.says("depth 3: 64x64")) << bare.outcome.text;
    const CountedRun behind = run_behind(GetParam(), {client("osmesa"), file("behind"), how});
    EXPECT_EQ(behind.outcome.text, bare.outcome.text) << how;
    EXPECT_GT(behind.total().substituted, 0U) << how;
  }
}

TEST_P(OsMesa, OpenedByName) {
  for (const char* how : {"dlsym", "address"}) {
    EXPECT_GT(expect_same({client("osmesa_opened"), "libOSMesa.so.8", how}).total().calls, 3U) << how;
  }
}

TEST_P(OsMesa, OpenedByAbsolutePath) {
  for (const char* how : {"dlsym", "address"}) {
    const Words command{client("osmesa_opened"), LIBRARY_FOLDER "/libOSMesa.so.8", how};
    // The folder method does not affect paths: the program gets the real library and works without Understudy.
    if (GetParam() == InjectionMethod::folder) {
      const CountedRun run = run_behind(GetParam(), command);
      EXPECT_EQ(run.outcome.text, run_behind(InjectionMethod::none, command).outcome.text);
      EXPECT_TRUE(run.processes.empty());
    } else {
      EXPECT_GT(expect_same(command).total().calls, 3U) << how;
    }
  }
}

UNDER_EVERY_METHOD(OsMesa);

// Programs probe whether OSMesa exists. (With the folder method they cannot: interceptor/README.md.)
class WhereThereIsNoOsMesa : public UnderInjection {};

TEST_P(WhereThereIsNoOsMesa, AProgramIsTold) {
  const CountedRun run =
      run_behind(GetParam(), {client("osmesa_opened"), "/nonexistent/libOSMesa.so.8", "dlsym"});
  EXPECT_EQ(run.outcome.text, "cannot be opened\n");
  EXPECT_EQ(run.outcome.status, 0);
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, WhereThereIsNoOsMesa,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
