// SPDX-License-Identifier: Apache-2.0
// One rank or four give the same image, even with a transfer function so narrow that most samples miss it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

/// A gyroid around 0.5, as floats.
std::string waves(const TemporaryFolder& folder, int side) {
  std::vector<float> values;
  const auto at = [&](int i) { return 12.0 * i / (side - 1) - 6; };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        values.push_back(float(0.5 + (std::sin(at(x)) * std::cos(at(y)) + std::sin(at(y)) * std::cos(at(z)) +
                                      std::sin(at(z)) * std::cos(at(x))) /
                                         6));
  const std::string length = std::to_string(side);
  return folder.write("waves_" + length + "x" + length + "x" + length + "_f32.raw",
                      std::as_bytes(std::span(values)));
}

TEST_F(Render, ANarrowTableShowsTheSameOnOneRankAndOnFour) {
  const std::string common = waves(folder_, 64) + " --size 256x256 --camera 31,29,2.3 --transfer-function " +
                             folder_.write("narrow.json", R"({
        "positions": "values", "knots": [{"at": 0, "colour": [0.2, 0.4, 1], "opacity": 0},
        {"at": 0.598, "colour": [0.2, 0.4, 1], "opacity": 0}, {"at": 0.6, "colour": [1, 0.9, 0.5], "opacity": 0.9},
        {"at": 0.602, "colour": [1, 0.4, 0.2], "opacity": 0}, {"at": 1, "colour": [1, 0.4, 0.2], "opacity": 0}]})");
  for (const char* method : {"post-classified", "pre-integrated"}) {
    std::vector<RgbaImage> floats, bytes;
    for (const char* ranks : {"1", "4"}) {
      floats.push_back(image(fmt::format("{} --method {} -n {}", common, method, ranks)));
      bytes.push_back(read_image(folder_.file("p.png")));
    }
    const Difference apart = difference(floats[1], floats[0]), shown = difference(bytes[1], bytes[0]);
    std::printf("%s, four ranks from one: at most %.1e; rounded to bytes RMS %.2f/255\n", method, apart.max,
                255 * shown.rms);
    EXPECT_LE(apart.max, 1e-5);
    EXPECT_LE(255 * shown.rms, 0.05);
  }
  // Other sample positions give another image, so the narrow table makes the test sensitive.
  const Difference other = difference(image(common + " --step 0.97"), image(common));
  EXPECT_GT(255 * other.rms, 10);
}

}  // namespace
}  // namespace understudy::launcher
