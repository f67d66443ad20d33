// SPDX-License-Identifier: Apache-2.0
// Runs a program bare and under an injection method: its output, and Understudy's counters.
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

/// Counters of one process that opened the core library.
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
  /// Runs `command` bare, which must succeed, and under the injection method, which must give the same output
  /// and status. Returns the run under the injection method.
  static CountedRun expect_same(const Words& command, const Words& environment = {});

  std::string file(const std::string& name) const { return folder_.file(name); }

 private:
  viewer_test::TemporaryFolder folder_;
};

std::string client(const std::string& name);

/// PSNR in dB of the bytes of two files; 0 if their lengths differ.
double psnr_of_files(const std::string& a, const std::string& b);

/// Instantiates a test for every injection method.
#define UNDER_EVERY_METHOD(Suite)                                                                   \
  INSTANTIATE_TEST_SUITE_P(                                                                         \
      InjectionMethods, Suite,                                                                      \
      ::testing::Values(InjectionMethod::preload, InjectionMethod::folder, InjectionMethod::audit), \
      [](const auto& info) { return name_of(info.param); })

}  // namespace understudy::testing
