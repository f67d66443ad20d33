// SPDX-License-Identifier: Apache-2.0
#include "tests/injection/under_injection.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "spu/report/report.h"

namespace understudy::testing {
namespace {

std::vector<unsigned char> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Counted CountedRun::total() const {
  Counted sum;
  for (const Counted& process : processes) {
    sum.calls += process.calls;
    sum.frames += process.frames;
    sum.substituted += process.substituted;
  }
  return sum;
}

CountedRun run_behind(InjectionMethod injection, const Words& command, Words environment) {
  const viewer_test::TemporaryFolder counters;
  for (const std::string& variable : environment_of(injection)) environment.push_back(variable);
  environment.push_back("UNDERSTUDY_RUN_DIR=" + counters.file(""));
  environment.push_back("LIBGL_ALWAYS_SOFTWARE=1");
  CountedRun run{run_program(environment, command), {}};
  for (const auto& process : spu::read_counters(counters.file(""))) {
    Counted counted{0, process->frames, process->frames_substituted};
    for (const std::uint64_t& calls : process->calls) counted.calls += calls;
    run.processes.push_back(counted);
  }
  return run;
}

CountedRun UnderInjection::expect_same(const Words& command, const Words& environment) {
  const CountedRun bare = run_behind(InjectionMethod::none, command, environment);
  EXPECT_EQ(bare.outcome.status, 0) << bare.outcome.text;
  EXPECT_TRUE(bare.processes.empty());
  CountedRun behind = run_behind(GetParam(), command, environment);
  EXPECT_EQ(behind.outcome.status, bare.outcome.status);
  EXPECT_EQ(behind.outcome.text, bare.outcome.text);
  EXPECT_FALSE(behind.processes.empty()) << "nothing came through the injection method";
  return behind;
}

std::string client(const std::string& name) {
  return CLIENTS "/" + name;
}

double psnr_of_files(const std::string& a, const std::string& b) {
  const std::vector<unsigned char> first = bytes_of(a);
  const std::vector<unsigned char> second = bytes_of(b);
  if (first.empty() || first.size() != second.size()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < first.size(); ++i) sum += std::pow(double(first[i]) - second[i], 2);
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * double(first.size()) / sum);
}

}  // namespace understudy::testing
