// SPDX-License-Identifier: Apache-2.0
// Another interposer in front of Understudy: `apitrace trace understudy run ... program`. Its library is
// preloaded, intercepts every OpenGL library that is opened, and treats Understudy as the driver.
// (tests/clients/driver_calls_test.cc covers apitrace behind Understudy.)
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/injection/under_injection.h"

namespace {

using namespace understudy::testing;

bool installed(const std::string& program) {
  return run_program({}, {"sh", "-c", "command -v " + program}).status == 0;
}

class UnderATracer : public UnderInjection {
 protected:
  void SetUp() override {
    if (!installed("apitrace")) GTEST_SKIP() << "apitrace is not installed (Debian: apitrace)";
  }

  Outcome traced(const Words& program) const {
    Words command{"apitrace",
                  "trace",
                  "-a",
                  "egl",
                  "-o",
                  file("trace"),
                  UNDERSTUDY_PROGRAM,
                  "run",
                  "--injection",
                  name_of(GetParam()),
                  "--report",
                  file("report.json"),
                  "--"};
    command.insert(command.end(), program.begin(), program.end());
    return run_program({"LIBGL_ALWAYS_SOFTWARE=1"}, command);
  }
  nlohmann::json report() const {
    std::ifstream stream(file("report.json"));
    return nlohmann::json::parse(stream);
  }
  std::string recorded() const {
    return run_program({}, {"apitrace", "dump", "--color=never", file("trace")}).text;
  }
};

TEST_P(UnderATracer, AProgramDrawsAsItDoesAlone) {
  for (const char* scene : {"by_address", "no_context"}) {
    const Words program{client("oddities"), scene};
    const Outcome outcome = traced(program);
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    for (const std::string& line : run_behind(InjectionMethod::none, program).outcome.lines())
      EXPECT_TRUE(outcome.says(line)) << line << " is not in\n" << outcome.text;
    EXPECT_GT(report().at("processes").at(0).at("calls"), 2) << scene;
  }
}

TEST_P(UnderATracer, AVolumeIsSubstituted) {
  const Outcome outcome = traced({client("threads"), "volumes", file("behind")});
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  run_behind(InjectionMethod::none, {client("threads"), "volumes", file("bare")});
  EXPECT_GT(report().at("frames_substituted"), 8);
  EXPECT_GT(psnr_of_files(file("bare"), file("behind")), 40);
}

// With LD_PRELOAD the launcher puts Understudy first, so a preloaded tracer sees no calls.
TEST_P(UnderATracer, TheTracerRecordsWhatTheProgramCalls) {
  traced({client("oddities"), "by_address"});
  EXPECT_EQ(recorded().find("glClear(mask = GL_COLOR_BUFFER_BIT)") == std::string::npos,
            GetParam() == InjectionMethod::preload);
}

UNDER_EVERY_METHOD(UnderATracer);

}  // namespace
