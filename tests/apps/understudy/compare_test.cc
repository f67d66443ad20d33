// SPDX-License-Identifier: Apache-2.0
// `understudy compare`: the differences between two images, and the file formats that it reads.
#include "apps/understudy/cli/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

RgbaImage grey_image(int width, int height, float value) {
  RgbaImage image;
  image.width = width;
  image.height = height;
  image.rgba.assign(4 * static_cast<std::size_t>(width) * height, value);
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1;
  return image;
}

class CompareFiles : public ::testing::Test {
 protected:
  CompareFiles() { fs::create_directories(folder_); }
  ~CompareFiles() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  /// Bottom row first, as in PFM.
  fs::path pfm(const std::string& name, const std::string& kind, int width, int height,
               const std::vector<float>& values, bool little_endian = true) const {
    std::string text = kind + "\n" + std::to_string(width) + " " + std::to_string(height) + "\n" +
                       (little_endian ? "-1.0\n" : "1.0\n");
    for (const float value : values) {
      auto bits = std::bit_cast<std::uint32_t>(value);
      if (!little_endian) bits = __builtin_bswap32(bits);
      text.append(reinterpret_cast<const char*>(&bits), sizeof bits);
    }
    return file(name, text);
  }

  fs::path folder_ = fs::temp_directory_path() / ("understudy-compare-" + std::to_string(getpid()));
};

TEST(Difference, IsZeroAndThePsnrInfiniteForEqualImages) {
  const RgbaImage image = grey_image(7, 3, 0.25F);
  const Difference found = difference(image, image);
  EXPECT_EQ(found.max, 0);
  EXPECT_EQ(found.rms, 0);
  EXPECT_EQ(difference_text(found), "max 0.0000\nRMS 0.0000\nPSNR inf dB\n");
}

TEST(Difference, OfAConstantTenthIsATenthAndTwentyDecibels) {
  const Difference found = difference(grey_image(16, 16, 0.5F), grey_image(16, 16, 0.6F));
  EXPECT_NEAR(found.max, 0.1, 1e-7);
  EXPECT_NEAR(found.rms, 0.1, 1e-7);
  EXPECT_NEAR(found.psnr(), 20.0, 1e-5);
  EXPECT_EQ(difference_text(found), "max 0.1000\nRMS 0.1000\nPSNR 20.00 dB\n");
}

TEST(Difference, OfOnePixelInAHundredIsATenthOfItsSizeInRms) {
  const RgbaImage a = grey_image(10, 10, 0.5F);
  RgbaImage b = a;
  for (int channel = 0; channel < 3; ++channel) b.pixel(4, 7)[channel] = 0.75F;
  const Difference found = difference(a, b);
  EXPECT_EQ(found.max, 0.25);
  EXPECT_NEAR(found.rms, 0.025, 1e-12);
  const RgbaImage map = difference_map(a, b);
  EXPECT_EQ(map.pixel(4, 7)[0], 1.0F);
  EXPECT_EQ(map.pixel(7, 4)[0], 0.0F);
}

TEST(Difference, CountsAlphaOnlyWhereAnImageHasSome) {
  const RgbaImage a = grey_image(4, 4, 0.5F);
  RgbaImage b = a;
  for (std::size_t i = 3; i < b.rgba.size(); i += 4) b.rgba[i] = 0.5F;
  EXPECT_EQ(difference(a, b).max, 0);
  b.has_alpha = true;
  EXPECT_EQ(difference(a, b).max, 0.5);
}

TEST(Difference, OfImagesOfTwoSizesIsRefusedWithBothSizes) {
  EXPECT_THAT([] { difference(grey_image(4, 5, 0), grey_image(5, 4, 0)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("4 x 5 and 5 x 4")));
}

TEST(Difference, OfANumberThatIsNoneIsRefusedWithItsPixel) {
  RgbaImage a = grey_image(3, 3, 0.5F);
  a.pixel(2, 1)[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { difference(a, grey_image(3, 3, 0.5F)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("pixel 2, 1")));
}

TEST_F(CompareFiles, PngComesBackAsItWasWrittenToWithinHalfAStep) {
  RgbaImage image = grey_image(33, 17, 0);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.pixel(x, y)[1] = static_cast<float>(x + y) / 50.0F;
  }
  write_png(folder_ / "ramp.png", image);
  const Difference found = difference(image, read_image(folder_ / "ramp.png"));
  RecordProperty("max", std::to_string(found.max));
  EXPECT_LE(found.max, 0.5 / 255 + 1e-6);
}

TEST_F(CompareFiles, PfmRowsRunBottomUpInEitherByteOrder) {
  const std::vector<float> values{0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F};  // one column of two pixels
  for (const bool little_endian : {true, false}) {
    const RgbaImage image = read_image(pfm("a.pfm", "PF", 1, 2, values, little_endian));
    EXPECT_EQ(image.pixel(0, 1)[0], 0.1F);
    EXPECT_EQ(image.pixel(0, 0)[2], 0.6F);
    EXPECT_FALSE(image.has_alpha);
  }
}

TEST_F(CompareFiles, PfmTakesItsAlphaFromTheFileBesideIt) {
  pfm("frame_0003_alpha.pfm", "Pf", 1, 1, {0.75F});
  const RgbaImage image = read_image(pfm("frame_0003.pfm", "PF", 1, 1, {0.1F, 0.2F, 0.3F}));
  EXPECT_TRUE(image.has_alpha);
  EXPECT_EQ(image.pixel(0, 0)[3], 0.75F);
}

TEST_F(CompareFiles, ATruncatedPfmIsRefusedWithWhatItHolds) {
  const fs::path path = file("short.pfm", "PF\n4 4\n-1.0\nabcd");
  EXPECT_THAT([&] { read_image(path); },
              ThrowsMessage<std::runtime_error>(HasSubstr("ends after 4 of 192 bytes")));
}

TEST_F(CompareFiles, ASizeOverTheLimitIsRefusedBeforeAnyMemoryIsTaken) {
  const std::string side = std::to_string(max_image_side + 1);
  for (const std::string& size : {side + " 1", "1 " + side, std::string("16384 16384"), std::string("0 5")}) {
    const fs::path path = file("big.pfm", "PF\n" + size + "\n-1.0\n");
    EXPECT_THAT([&] { read_image(path); },
                ThrowsMessage<std::runtime_error>(HasSubstr("pixels; each side must be")));
  }
}

TEST_F(CompareFiles, AFileThatIsNoImageIsRefusedByName) {
  EXPECT_THAT([&] { read_image(file("notes.txt", "hello, world")); },
              ThrowsMessage<std::runtime_error>(HasSubstr("notes.txt: neither a PNG nor a PFM")));
  EXPECT_THAT([&] { read_image(folder_ / "missing.png"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("missing.png: No such file")));
}

}  // namespace
}  // namespace understudy::launcher
