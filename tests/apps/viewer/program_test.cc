// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <set>

#include "tests/apps/viewer/run_viewer.h"
#include "tests/apps/viewer/temporary_folder.h"
#include "tests/apps/viewer/virtual_display.h"

namespace viewer_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int image_edge = 40;

// A hollow 8-bit ball around a dense off-centre core; smooth, so that interpolation before and after
// classification differ little.
std::vector<std::uint8_t> ball() {
  std::vector<std::uint8_t> voxels;
  for (int z = 0; z < image_edge; ++z)
    for (int y = 0; y < image_edge; ++y)
      for (int x = 0; x < image_edge; ++x) {
        const auto radius = [&](double cx, double cy, double cz) {
          return std::hypot(x - cx, y - cy, z - cz) / image_edge;
        };
        const double shell = 0.55 * std::exp(-std::pow((radius(19.5, 19.5, 19.5) - 0.36) / 0.06, 2));
        const double core = std::exp(-std::pow(radius(24, 18, 22) / 0.10, 2));
        voxels.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(1.0, shell + core))));
      }
  return voxels;
}

std::string ball_file(const TemporaryFolder& folder) {
  const std::vector<std::uint8_t> voxels = ball();
  return folder.write("ball.40x40x40", std::as_bytes(std::span(voxels)));
}

struct Statistics {
  double lit = 0;  ///< share of pixels that are not black
  double mean = 0;
  std::size_t colours = 0;
};

Statistics statistics(const Image& image) {
  Statistics result;
  std::set<std::array<std::uint8_t, 3>> colours;
  const std::size_t pixels = image.rgb.size() / 3;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::array<std::uint8_t, 3> colour = {image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2]};
    colours.insert(colour);
    result.lit += (colour[0] | colour[1] | colour[2]) != 0;
    result.mean += (colour[0] + colour[1] + colour[2]) / 3.0;
  }
  result.lit /= static_cast<double>(pixels);
  result.mean /= static_cast<double>(pixels);
  result.colours = colours.size();
  return result;
}

Image image_of(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  const std::string png = folder.file("image.png");
  std::filesystem::remove(png);
  arguments.insert(arguments.end(), {"--offscreen", "--window-size", "128", "128", "--screenshot", png});
  const Outcome outcome = run_viewer(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return read_png(png);
}

TEST(Program, EveryModeDrawsTheBallAndTheModesAgree) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  std::vector<Image> images;
  for (const char* mode : {"rgba", "table", "core"}) {
    SCOPED_TRACE(mode);
    images.push_back(image_of(folder, {file, "--mode", mode}));
    const Image& image = images.back();
    ASSERT_EQ(image.width, 128);
    ASSERT_EQ(image.height, 128);
    const Statistics s = statistics(image);
    std::printf("%s: %.3f of the pixels lit, mean %.1f, %zu colours\n", mode, s.lit, s.mean, s.colours);
    EXPECT_GT(s.lit, 0.15);
    EXPECT_LT(s.lit, 0.7);
    EXPECT_GT(s.colours, 300U);
  }
  const Difference classification = difference(images[0], images[1]);
  const Difference profile = difference(images[1], images[2]);
  std::printf("rgba against table: PSNR %.2f dB; table against core: PSNR %.2f dB\n", classification.psnr,
              profile.psnr);
  // rgba and table differ only in the order of interpolation and classification, table and core only by
  // rounding.
  EXPECT_GT(classification.psnr, 30);
  EXPECT_GT(profile.psnr, 50);
}

TEST(Program, EveryOtherModeShowsTheSameBall) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Image table = image_of(folder, {file});
  // Bricks differ by rounding, pre-integration and stacks by what lies between samples, light by shading.
  for (const auto& [mode, likeness] :
       {std::pair{"time", 50.0}, {"bricks", 45.0}, {"preint", 30.0}, {"stacks", 24.0}, {"lit", 20.0}}) {
    const Difference d = difference(table, image_of(folder, {file, "--mode", mode}));
    std::printf("table against %s: PSNR %.2f dB\n", mode, d.psnr);
    EXPECT_GT(d.psnr, likeness) << mode;
  }
  const Image first = image_of(folder, {file, "--mode", "time"});
  EXPECT_NE(first.rgb, image_of(folder, {file, "--mode", "time", "--frames", "5"}).rgb) << "time goes on";
  EXPECT_NE(table.rgb, image_of(folder, {file, "--mode", "lit"}).rgb) << "there is light";
}

TEST(Program, BricksOfALargeVolumeShowNoSeams) {
  const TemporaryFolder folder;
  // Fog whose density changes slowly: a seam would be the only edge in the image.
  std::vector<std::uint8_t> voxels;
  constexpr int large = 100;
  for (int z = 0; z < large; ++z)
    for (int y = 0; y < large; ++y)
      for (int x = 0; x < large; ++x) voxels.push_back(static_cast<std::uint8_t>(x / 2 + y / 3 + z / 2));
  const std::string file = folder.write("fog.100x100x100", std::as_bytes(std::span(voxels)));
  for (const std::vector<std::string>& camera :
       std::vector<std::vector<std::string>>{{}, {"--ortho"}, {"--distance", "0.9"}, {"--azimuth", "200"}}) {
    std::vector<std::string> whole = {file, "--preset", "dense", "--no-frame"};
    whole.insert(whole.end(), camera.begin(), camera.end());
    std::vector<std::string> bricks = whole;
    bricks.insert(bricks.end(), {"--mode", "bricks"});
    const Difference d = difference(image_of(folder, whole), image_of(folder, bricks));
    std::printf("whole against bricks: PSNR %.2f dB\n", d.psnr);
    EXPECT_GT(d.psnr, 45);
  }
}

TEST(Program, UnderShowsWhatOverShows) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  for (const char* mode : {"rgba", "table", "core", "bricks", "stacks"}) {
    const std::vector<std::string> over = {file,  "--mode", mode,       "--background", "0.3",
                                           "0.5", "0.2",    "--opaque", "--second"};
    std::vector<std::string> under = over;
    under.insert(under.end(), {"--operator", "under"});
    const Difference d = difference(image_of(folder, over), image_of(folder, under));
    std::printf("%s, over against under: PSNR %.2f dB\n", mode, d.psnr);
    EXPECT_GT(d.psnr, 33) << mode;
  }
}

TEST(Program, OperatorsAndGeometryChangeTheImage) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  std::set<std::vector<std::uint8_t>> images;
  const std::vector<std::vector<std::string>> changes = {
      {},           {"--operator", "max"}, {"--operator", "min"},   {"--operator", "add"},
      {"--opaque"}, {"--second"},          {"--second", "--opaque"}};
  for (const std::vector<std::string>& change : changes) {
    std::vector<std::string> arguments = {file, "--background", "0.5", "0.5", "0.5"};
    arguments.insert(arguments.end(), change.begin(), change.end());
    images.insert(image_of(folder, arguments).rgb);
  }
  EXPECT_EQ(images.size(), changes.size());
}

TEST(Program, FrameAndAxesAreOutsideTheVolumeAndCanBeSwitchedOff) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Image with = image_of(folder, {file}), without = image_of(folder, {file, "--no-frame"});
  EXPECT_GT(statistics(with).lit, statistics(without).lit + 0.01);
  const auto pure_red = [](const Image& p) {
    for (std::size_t i = 0; i < p.rgb.size(); i += 3)
      if (p.rgb[i] > 80 && p.rgb[i + 1] < p.rgb[i] / 4 && p.rgb[i + 2] < p.rgb[i] / 4) return true;
    return false;
  };
  EXPECT_TRUE(pure_red(with)) << "the x axis";
  EXPECT_FALSE(pure_red(without));
}

TEST(Program, SolidFrameHidesAndIsHiddenByTheVolume) {
  const TemporaryFolder folder;
  // Opaque throughout, so that only frame lines in front of the block are visible over it.
  const std::string file = folder.write("block.16x16x16", std::string(std::size_t{16} * 16 * 16, '\xff'));
  const std::vector<std::string> arguments = {file, "--preset", "step"};
  std::vector<std::string> bare = arguments;
  bare.emplace_back("--no-frame");
  const Image with = image_of(folder, arguments), without = image_of(folder, bare);
  std::size_t block = 0, front_lines = 0;
  for (std::size_t i = 0; i < with.rgb.size(); i += 3) {
    if (without.rgb[i] == 0) continue;
    ++block;
    front_lines += std::memcmp(&with.rgb[i], &without.rgb[i], 3) != 0;
  }
  std::printf("%zu of %zu pixels of an opaque block show the frame or the axes\n", front_lines, block);
  EXPECT_GT(front_lines, 20U) << "lines in front are drawn over the block";
  EXPECT_LT(front_lines, block / 10) << "lines behind are not";
}

TEST(Program, TheSameOptionsGiveTheSameImageOnBothKindsOfSurface) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Image first = image_of(folder, {file, "--mode", "core"});
  EXPECT_EQ(first.rgb, image_of(folder, {file, "--mode", "core"}).rgb);
  const Image pbuffer = image_of(folder, {file, "--offscreen-surface", "pbuffer", "--no-frame"});
  const Image framebuffer = image_of(folder, {file, "--offscreen-surface", "framebuffer", "--no-frame"});
  const Difference d = difference(pbuffer, framebuffer);
  std::printf("pbuffer against framebuffer object: PSNR %.2f dB\n", d.psnr);
  EXPECT_GT(d.psnr, 50);
}

TEST(Program, AWindowShowsTheSameImage) {
  const std::optional<VirtualDisplay> display = VirtualDisplay::start();
  if (!display) GTEST_SKIP() << "Xvfb is not installed";
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  for (const char* mode : {"rgba", "table", "core"}) {
    SCOPED_TRACE(mode);
    const std::string png = folder.file("window.png");
    const Outcome outcome = run_viewer({file, "--mode", mode, "--frames", "2", "--window-size", "128", "128",
                                        "--screenshot", png, "--print-times"},
                                       display->name());
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("median: "));
    const Difference d = difference(read_png(png), image_of(folder, {file, "--mode", mode}));
    std::printf("%s: window against off screen: PSNR %.2f dB\n", mode, d.psnr);
    EXPECT_GT(d.psnr, 50);
  }
}

TEST(Program, OrbitTurnsTheLastFrameToWhereTheCameraWouldBe) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Image orbited = image_of(folder, {file, "--azimuth", "10", "--frames", "3", "--orbit", "15"});
  const Image placed = image_of(folder, {file, "--azimuth", "40"});
  EXPECT_EQ(orbited.rgb, placed.rgb);
  EXPECT_NE(orbited.rgb, image_of(folder, {file, "--azimuth", "10"}).rgb);
}

TEST(Program, OptionsChangeTheImage) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Image usual = image_of(folder, {file});
  for (const std::vector<std::string>& change :
       std::vector<std::vector<std::string>>{{"--preset", "3"},
                                             {"--ortho"},
                                             {"--elevation", "-30"},
                                             {"--distance", "1.2"},
                                             {"--slices", "20"},
                                             {"--spacing", "1", "1", "2"},
                                             {"--background", "0", "0", "1"}}) {
    std::vector<std::string> arguments = {file};
    arguments.insert(arguments.end(), change.begin(), change.end());
    EXPECT_NE(image_of(folder, arguments).rgb, usual.rgb) << change.front();
  }
}

TEST(Program, OpacityCorrectionKeepsTheImageOverTheNumberOfSlices) {
  const TemporaryFolder folder;
  const std::string file = ball_file(folder);
  const Difference corrected =
      difference(image_of(folder, {file, "--slices", "70"}), image_of(folder, {file, "--slices", "140"}));
  std::printf("70 against 140 slices: PSNR %.2f dB\n", corrected.psnr);
  EXPECT_GT(corrected.psnr, 40) << "uncorrected it would be 26 dB";
}

TEST(Program, EveryFrameIsTimedAndWrittenWhenAsked) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_viewer({ball_file(folder), "--offscreen", "--frames", "3", "--orbit", "90", "--window-size", "32",
                  "24", "--print-times", "--screenshot-frames", folder.file("frames")});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  for (const char* line : {"frame 0: ", "frame 1: ", "frame 2: ", "median: "})
    EXPECT_THAT(outcome.out, HasSubstr(line));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("frame 2: [0-9]+\\.[0-9][0-9] ms\n"));
  for (const char* name : {"frames/frame_0000.png", "frames/frame_0001.png", "frames/frame_0002.png"}) {
    const Image image = read_png(folder.file(name));
    EXPECT_EQ(image.width, 32);
    EXPECT_EQ(image.height, 24);
  }
  EXPECT_NE(read_png(folder.file("frames/frame_0000.png")).rgb,
            read_png(folder.file("frames/frame_0001.png")).rgb);
}

TEST(Program, BadFilesEndWithStatusOneAndAMessage) {
  const TemporaryFolder folder;
  const auto message = [&](std::vector<std::string> arguments) {
    arguments.emplace_back("--offscreen");
    const Outcome outcome = run_viewer(arguments);
    EXPECT_EQ(outcome.status, 1) << arguments.front();
    return outcome.err;
  };
  EXPECT_THAT(message({folder.file("absent.4x4x4")}), HasSubstr("no such file"));
  EXPECT_THAT(message({folder.write("short.4x4x4", std::string(63, 'x'))}),
              HasSubstr("expected 64 bytes, found 63"));
  EXPECT_THAT(message({folder.write("long.4x4x4", std::string(65, 'x'))}),
              HasSubstr("expected 64 bytes, found 65"));
  EXPECT_THAT(message({folder.write("zero.0x4x4", std::string())}), HasSubstr("contains no voxels"));
  EXPECT_THAT(message({folder.write("wide.60000x1x1", std::string(60000, 'x'))}),
              HasSubstr("GL_MAX_3D_TEXTURE_SIZE"));
  EXPECT_THAT(message({ball_file(folder), "--screenshot", folder.file("no/such/folder.png")}),
              HasSubstr("cannot be written"));
  EXPECT_THAT(message({ball_file(folder), "--describe", folder.file("no/such/folder.json")}),
              HasSubstr("cannot be written"));
}

TEST(Program, WrongOptionsEndWithStatusTwo) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"x.4x4x4", "--mode", "vulkan"},
                                             {"x.4x4x4", "--preset", "6"},
                                             {"x.4x4x4", "--frames", "0"},
                                             {"x.4x4x4", "--size", "4", "4"},
                                             {"x.4x4x4", "--window-size", "0", "100"},
                                             {"x.4x4x4", "--distance", "nan"},
                                             {"x.4x4x4", "--no-such-option"}}) {
    const Outcome outcome = run_viewer(arguments);
    EXPECT_EQ(outcome.status, 2) << (arguments.empty() ? "(no options)" : arguments.back());
    EXPECT_THAT(outcome.err, Not(testing::IsEmpty()));
  }
  EXPECT_EQ(run_viewer({"--help"}).status, 0);
}

TEST(Program, WithoutADisplayAWindowEndsWithStatusThreeAndNamesTheWayOut) {
  const TemporaryFolder folder;
  const Outcome outcome = run_viewer({ball_file(folder), "--frames", "1"});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("no window"), HasSubstr("--offscreen")));
}

TEST(Program, NaNVoxelsAreShownAsEmptyWithOneWarning) {
  const TemporaryFolder folder;
  // Fog everywhere: only "empty" can explain a hole.
  std::vector<float> voxels(std::size_t{16} * 16 * 16, 1.0F);
  voxels[0] = 0.0F;
  const std::string whole = folder.write("whole.raw", std::as_bytes(std::span(voxels)));
  std::fill(voxels.begin() + 1, voxels.end(), std::numeric_limits<float>::quiet_NaN());
  voxels[16] = 1.0F;
  const std::string holed = folder.write("holed.raw", std::as_bytes(std::span(voxels)));
  for (const char* mode : {"rgba", "table", "core"}) {
    const std::string png = folder.file("nan.png");
    const std::vector<std::string> options = {
        "--size", "16",           "16", "16",          "--type",     "f32",           "--preset",
        "dense",  "--mode",       mode, "--offscreen", "--no-frame", "--window-size", "64",
        "64",     "--screenshot", png};
    const auto run = [&](const std::string& file) {
      std::vector<std::string> arguments = {file};
      arguments.insert(arguments.end(), options.begin(), options.end());
      return run_viewer(arguments);
    };
    EXPECT_EQ(run(whole).err, "");
    const double fog = statistics(read_png(png)).lit;
    const Outcome outcome = run(holed);
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("4094 of 4096 voxels are NaN"));
    const double rest = statistics(read_png(png)).lit;
    std::printf("%s: lit %.3f whole, %.3f holed\n", mode, fog, rest);
    EXPECT_GT(fog, 0.2);
    EXPECT_LT(rest, 0.1 * fog);
  }
}

TEST(Program, LinksAndIncludesNothingOfTheProject) {
  const Outcome linked = run_program({"ldd", VIEWER_PROGRAM});
  EXPECT_EQ(linked.status, 0);
  EXPECT_THAT(linked.out, HasSubstr("libGL"));
  EXPECT_THAT(linked.out, Not(HasSubstr("understudy")));

  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(VIEWER_SOURCES)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".h" && extension != ".cc") continue;
    ++files;
    std::ifstream file(entry.path());
    for (std::string line; std::getline(file, line);)
      if (line.starts_with("#include \"")) {
        EXPECT_THAT(line, testing::StartsWith("#include \"apps/viewer/")) << entry.path();
      }
  }
  EXPECT_GT(files, 20);
}

}  // namespace
}  // namespace viewer_test
