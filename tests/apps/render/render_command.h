// SPDX-License-Identifier: Apache-2.0
// Runs `understudy render` from a test, in a separate folder.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/understudy/cli/compare.h"
#include "apps/understudy/images/image.h"
#include "tests/apps/viewer/temporary_folder.h"

namespace understudy::launcher {

using viewer_test::TemporaryFolder;
using Json = nlohmann::json;

struct Result {
  int status = 0;
  std::string output;  ///< stdout and stderr
};

inline Result shell(const std::string& command) {
  Result result;
  std::FILE* output = popen(("exec 2>&1; " + command).c_str(), "r");
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), output)) > 0;)
    result.output.append(part.data(), count);
  const int status = pclose(output);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  return result;
}

class Render : public ::testing::Test {
 protected:
  /// The arguments are parsed by the shell.
  Result render(const std::string& arguments) const {
    return shell(std::string(UNDERSTUDY_PROGRAM) + " render --out " + folder_.file("p.png") + " " + arguments);
  }
  Json report() const { return Json::parse(std::ifstream(folder_.file("r.json"))); }

  /// A ball with a soft rim, brighter along x, in double precision.
  std::string ball(int side) const {
    std::vector<double> values;
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const double r = std::hypot(x - side / 2.0, y - side / 2.0, z - side / 2.0) / side;
          values.push_back((0.5 - 0.5 * std::tanh((r - 0.35) / 0.05)) * (1 + double(x) / side) - 1.0 / 3);
        }
    const std::string name =
        "ball_" + std::to_string(side) + "x" + std::to_string(side) + "x" + std::to_string(side);
    return folder_.write(name + "_f64.raw", std::as_bytes(std::span(values)));
  }

  /// The image before rounding; expects the rendering to succeed.
  RgbaImage image(const std::string& arguments) const {
    const Result result = render(arguments + " --save-float " + folder_.file("f.pfm"));
    EXPECT_EQ(result.status, 0) << arguments << ": " << result.output;
    return read_image(folder_.file("f.pfm"));
  }

  TemporaryFolder folder_;
};

}  // namespace understudy::launcher
