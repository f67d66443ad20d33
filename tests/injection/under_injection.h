// SPDX-License-Identifier: Apache-2.0
// A program, bare and under an injection method: what it printed, and what Understudy counted.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/apps/viewer/temporary_folder.h"
#include "tests/interceptor/run_program.h"
#include "tests/loader/injection_methods.h"

namespace understudy::testing {

using Words = std::vector<std::string>;

/// Of one process that came to the core.
struct Counted {
  std::uint64_t calls = 0;
  std::uint64_t frames = 0;
  std::uint64_t substituted = 0;
};

struct CountedRun {
  Outcome outcome;
  std::vector<Counted> processes;

  Counted total() const;
};

CountedRun run_behind(InjectionMethod injection, const Words& command, Words environment = {});

class UnderInjection : public ::testing::TestWithParam<InjectionMethod> {
 protected:
  /// Runs it bare, which must go well, and under the injection method, which must print and answer the same.
  /// The answer is the run under the injection method.
  static CountedRun expect_same(const Words& command, const Words& environment = {});

  std::string file(const std::string& name) const { return folder_.file(name); }

 private:
  viewer_test::TemporaryFolder folder_;
};

std::string client(const std::string& name);

/// In dB, of two files of bytes; 0 when they are of different lengths.
double psnr_of_files(const std::string& a, const std::string& b);

/// An instance of a test for every injection method.
#define UNDER_EVERY_METHOD(Suite)                                                                   \
  INSTANTIATE_TEST_SUITE_P(                                                                         \
      InjectionMethods, Suite,                                                                      \
      ::testing::Values(InjectionMethod::preload, InjectionMethod::folder, InjectionMethod::audit), \
      [](const auto& info) { return name_of(info.param); })

}  // namespace understudy::testing
