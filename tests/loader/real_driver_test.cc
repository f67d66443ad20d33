// SPDX-License-Identifier: Apache-2.0
// glxinfo and eglinfo query nearly everything that a driver can be asked. Under an injection method they must
// get the same answers.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "injection_methods.h"
#include "run_program.h"

namespace {

using namespace understudy::testing;

/// An X server, as long as the object lives. `display` is empty if none could be started.
class VirtualScreen {
 public:
  VirtualScreen() {
    int ready[2];
    if (pipe(ready) != 0) return;
    server_ = fork();
    if (server_ == 0) {
      close(ready[0]);
      const std::string descriptor = std::to_string(ready[1]);
      if (freopen("/dev/null", "w", stderr) == nullptr) _exit(127);
      // -noreset: otherwise a client that connects just as the last one leaves is sometimes refused.
      execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-noreset", "-screen", "0", "640x480x24",
             nullptr);
      _exit(127);
    }
    close(ready[1]);
    std::string number;
    for (char c; read(ready[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ready[0]);
    if (!number.empty()) display_ = ":" + number;
  }
  ~VirtualScreen() {
    if (server_ <= 0) return;
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;

  const std::string& display() const { return display_; }

 private:
  pid_t server_ = -1;
  std::string display_;
};

bool installed(const std::string& program) {
  return run_program({}, {"sh", "-c", "command -v " + program}).status == 0;
}

class RealDriver : public ::testing::TestWithParam<InjectionMethod> {
 protected:
  static std::string output(InjectionMethod injection, const std::string& disable, const std::string& display,
                            const std::vector<std::string>& command) {
    std::vector<std::string> environment = environment_of(injection);
    environment.push_back("DISPLAY=" + display);
    environment.push_back("UNDERSTUDY_DISABLE=" + disable);
    const Outcome outcome = run_program(environment, command);
    EXPECT_EQ(outcome.status, run_program({"DISPLAY=" + display}, command).status) << outcome.text;
    return outcome.text;
  }

  static void expect_same(const std::vector<std::string>& command) {
    if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed (Debian: xvfb)";
    if (!installed(command[0])) GTEST_SKIP() << command[0] << " is not installed (Debian: mesa-utils)";
    const VirtualScreen screen;
    ASSERT_FALSE(screen.display().empty()) << "Xvfb does not start";
    const std::string bare = output(InjectionMethod::none, "0", screen.display(), command);
    ASSERT_GT(bare.size(), 500u) << bare;
    for (const char* disable : {"0", "1"}) {
      EXPECT_EQ(output(GetParam(), disable, screen.display(), command), bare)
          << name_of(GetParam()) << ", UNDERSTUDY_DISABLE=" << disable;
    }
  }
};

TEST_P(RealDriver, GlxinfoSaysTheSame) {
  expect_same({"glxinfo", "-B"});
}
TEST_P(RealDriver, GlxinfoInFullSaysTheSame) {
  expect_same({"glxinfo", "-l"});
}
TEST_P(RealDriver, EglinfoSaysTheSame) {
  expect_same({"eglinfo"});
}

INSTANTIATE_TEST_SUITE_P(InjectionMethods, RealDriver,
                         ::testing::Values(InjectionMethod::preload, InjectionMethod::folder,
                                           InjectionMethod::audit),
                         [](const auto& info) { return name_of(info.param); });

}  // namespace
