// SPDX-License-Identifier: Apache-2.0
// Levels of detail of a hierarchical volume, as images: each has the volume's position and colours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/apps/render/render_command.h"
#include "volume/file/hierarchical_writer.h"
#include "volume/opening/open_volume.h"

namespace understudy::launcher {
namespace {

using ::testing::HasSubstr;

/// A field that is linear in an oblique direction: interpolation of any level reproduces it.
std::string slope_in_levels(const viewer_test::TemporaryFolder& folder) {
  constexpr int edge = 131;
  std::vector<float> values;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) values.push_back(float(x + 2 * y + 3 * z));
  const auto bytes = std::as_bytes(std::span(values));
  const auto raw = volume::open_volume(folder.write("slope_131x131x131_f32.raw", bytes));
  const std::string path = folder.file("slope.uvol");
  volume::write_hierarchical(*raw, path, {});
  return path;
}

TEST_F(Render, ALevelLiesWhereTheVolumeLies) {
  const std::string file = slope_in_levels(folder_);
  std::vector<RgbaImage> images;
  // Steps of equal length in all of them.
  for (const char* options : {" --step 4", " --level 1 --step 2", " --level 2"}) {
    const Result result =
        render(file + options + std::string(" --transfer-function rainbow --size 80x80 --save-float ") +
               folder_.file("f.pfm") + " --report " + folder_.file("r.json"));
    ASSERT_EQ(result.status, 0) << result.output;
    images.push_back(read_image(folder_.file("f.pfm")));
  }
  EXPECT_EQ(report()["volume"]["level_of_detail"]["level"], 2);
  EXPECT_EQ(report()["volume"]["level_of_detail"]["volume_size"], Json({131, 131, 131}));
  EXPECT_EQ(report()["volume"]["size"], Json({33, 33, 33}));
  for (std::size_t level = 1; level < images.size(); ++level) {
    const double rms = difference(images[0], images[level]).rms;
    std::printf("level %zu: rms %.1e\n", level, rms);
    // Within half a voxel of the volume's sides the outermost values are repeated; those of a level lie further
    // inside.
    EXPECT_LT(rms, 5e-3) << "level " << level;
  }
}

#ifdef UNDERSTUDY_HAS_NODES
TEST_F(Render, ALevelHasTheSameImageOnNodes) {
  const std::string file =
      slope_in_levels(folder_) + " --level 1 --size 60x60 --save-float " + folder_.file("f.pfm");
  ASSERT_EQ(render(file).status, 0);
  const RgbaImage here = read_image(folder_.file("f.pfm"));
  ASSERT_EQ(render(file + " -n 3").status, 0);
  EXPECT_LT(difference(here, read_image(folder_.file("f.pfm"))).max, 1e-5);
}
#endif

TEST_F(Render, ALevelThatThereIsNotIsRefused) {
  const std::string file = slope_in_levels(folder_);
  Result result = render(file + " --level 7");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("its levels are 0 to 2"));
  result = render(ball(8) + " --level 1");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("understudy convert"));
  result = render(file + " --level 1 --error-bound");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.output, HasSubstr("leave out --level"));
}

}  // namespace
}  // namespace understudy::launcher
