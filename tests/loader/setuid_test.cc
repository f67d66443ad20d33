// SPDX-License-Identifier: Apache-2.0
// Programs that run with the rights of their file's owner: the loader allows no injection, and they must work
// all the same.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "injection_methods.h"
#include "run_program.h"
#include "tests/apps/viewer/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace understudy::testing;

class Setuid : public ::testing::TestWithParam<InjectionMethod> {
 protected:
  void SetUp() override {
    if (geteuid() != 0) GTEST_SKIP() << "only root can make such a program and run it as somebody else";
    fs::permissions(folder_.file(""), fs::perms(0755));
    fs::copy_file(CLIENTS "/linked_gl", program());
    if (as_nobody(InjectionMethod::none).text != "done\n")
      GTEST_SKIP() << "user 65534 cannot reach this build folder or " << folder_.file("");
  }

  std::string program() const { return folder_.file("program"); }

  Outcome as_nobody(InjectionMethod injection) const {
    std::vector<std::string> environment = environment_of(injection);
    environment.emplace_back("UNDERSTUDY_DRIVER_DIR=" TEST_DRIVER);
    return run_program(environment, {"setpriv", "--reuid=65534", "--clear-groups", program()});
  }

 private:
  viewer_test::TemporaryFolder folder_;
};

TEST_P(Setuid, IsLeftAloneAndACopyWithoutThePrivilegeIsNot) {
  if (!as_nobody(GetParam()).says("driver: glClear"))
    GTEST_SKIP() << "user 65534 cannot reach the injection method: " << as_nobody(GetParam()).text;
  ASSERT_EQ(chmod(program().c_str(), 04755), 0);
  const Outcome privileged = as_nobody(GetParam());
  EXPECT_EQ(privileged.text, "done\n");
  EXPECT_EQ(privileged.status, 0);
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, Setuid,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::folder,
                                           InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
