// SPDX-License-Identifier: Apache-2.0
// `understudy render` as seen by its user: images of files without a viewer, in one process and on nodes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Render, ATimeStepOfAFileThatHoldsSeveral) {
  std::vector<std::byte> all;
  for (unsigned step = 0; step < 3; ++step) {
    std::vector<std::byte> values;
    for (unsigned i = 0; i < 20 * 18 * 16; ++i) values.push_back(std::byte(i * (step + 3) / 7));
    folder_.write("step" + std::to_string(step) + "_20x18x16.raw", std::as_bytes(std::span(values)));
    all.insert(all.end(), values.begin(), values.end());
  }
  const std::string header = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 20 18 16 3\nencoding: raw\n\n";
  const auto* const text = reinterpret_cast<const std::byte*>(header.data());
  all.insert(all.begin(), text, text + header.size());
  const std::string series = folder_.write("series.nrrd", std::span<const std::byte>(all));
  for (const char* step : {"0", "2"}) {
    const RgbaImage expected = image(folder_.file("step") + step + "_20x18x16.raw --size 40x40");
    const std::string of_series =
        series + " --size 40x40 --time-step " + step + " --report " + folder_.file("r.json");
    EXPECT_EQ(difference(image(of_series), expected).rms, 0);
    EXPECT_EQ(report()["volume"]["time_step"], std::stoi(step));
#ifdef UNDERSTUDY_HAS_NODES
    EXPECT_LT(difference(image(of_series + " -n 2"), expected).rms, 1e-6);
#endif
  }
  // Steps are numbered consecutively over several files.
  EXPECT_EQ(difference(image(series + " " + series + " --size 40x40 --time-step 5"),
                       image(folder_.file("step2_20x18x16.raw") + " --size 40x40"))
                .rms,
            0);
  EXPECT_THAT(render(series + " --time-step 3").output, HasSubstr("there is no time step 3; the series has 3"));
  const Result converted = shell(std::string(UNDERSTUDY_PROGRAM) + " convert --time-step 2 " + series + " -o " +
                                 folder_.file("s.uvol"));
  ASSERT_EQ(converted.status, 0) << converted.output;
  EXPECT_EQ(difference(image(folder_.file("s.uvol") + " --size 40x40"),
                       image(folder_.file("step2_20x18x16.raw") + " --size 40x40"))
                .rms,
            0);
}

TEST_F(Render, AnImageAndAReportOfAFile) {
  const std::string file = ball(40);
  const Result result = render(file + " --transfer-function vessels --size 120x90 --frames 3 --report " +
                               folder_.file("r.json") + " --save-float " + folder_.file("f.pfm"));
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("40 x 40 x 40 of f64, in this process"), HasSubstr("3 frames"),
                                   HasSubstr("converted to f32 texels")));
  const RgbaImage image = read_image(folder_.file("p.png"));
  EXPECT_EQ(image.width, 120);
  EXPECT_EQ(image.height, 90);
  const float* middle = image.pixel(60, 45);
  EXPECT_GT(middle[0] + middle[1] + middle[2], 0.5F) << "the ball is to be seen";
  const float* corner = image.pixel(2, 2);
  EXPECT_EQ(corner[0] + corner[1] + corner[2], 0.0F);
  const RgbaImage exact = read_image(folder_.file("f.pfm"));
  EXPECT_TRUE(exact.has_alpha);
  EXPECT_GT(exact.pixel(60, 45)[3], 0.5F);
  EXPECT_EQ(exact.pixel(2, 2)[3], 0.0F);
  EXPECT_NEAR(exact.pixel(60, 45)[0], middle[0], 0.5 / 255 + 1e-6) << "the PNG is the image, rounded";

  const Json json = report();
  EXPECT_EQ(json["volume"]["size"], Json({40, 40, 40}));
  EXPECT_EQ(json["volume"]["scalar_type"], "f64");
  EXPECT_EQ(json["volume"]["texel_type"], "f32");
  EXPECT_NEAR(double(json["volume"]["values"][0]), -1.0 / 3, 0.01);
  EXPECT_GT(double(json["volume"]["largest_conversion_error"]), 0);
  EXPECT_LT(double(json["volume"]["largest_conversion_error"]), 1e-6);
  EXPECT_EQ(json["frames_ms"].size(), 3U);
  EXPECT_EQ(json["nodes"], 0);
  EXPECT_GT(json["samples"], json["samples_taken"]);
  EXPECT_EQ(json["left_out"]["samples_skipped"],
            std::int64_t(json["samples"]) - std::int64_t(json["samples_taken"]));
  ASSERT_EQ(json["ranks"].size(), 1U);
  EXPECT_GE(json["ranks"][0]["bytes_read"], 40 * 40 * 40 * 8);
  EXPECT_LE(json["ranks"][0]["bytes_read"], 40 * 40 * 40 * 8 + 4);
  EXPECT_GT(json["ranks"][0]["peak_bytes"], json["ranks"][0]["brick_bytes"]);
}

TEST_F(Render, SmallerStepsComeNearerToOneImage) {
  const std::string file = ball(32);
  std::vector<RgbaImage> images;
  for (const char* step : {"2", "1", "0.5", "0.125"}) {
    ASSERT_EQ(render(file + " --transfer-function rainbow --size 60x60 --step " + step + " --save-float " +
                     folder_.file("f.pfm"))
                  .status,
              0);
    images.push_back(read_image(folder_.file("f.pfm")));
  }
  double before = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double rms = difference(images[i], images.back()).rms;
    std::printf("rms %.2e\n", rms);
    EXPECT_LT(rms, before / 1.5);
    before = rms;
  }
}

TEST_F(Render, TheWaysToSayTheSameGiveTheSameImage) {
  const std::string file = ball(24);
  const std::string common = " --size 50x50 --save-float " + folder_.file("f.pfm");
  ASSERT_EQ(render(file + common).status, 0);
  const RgbaImage expected = read_image(folder_.file("f.pfm"));
  // The built-in transfer function as a file; size and type as options instead of in the file name.
  const std::string control_points =
      folder_.write("grey.json", std::string(R"({"knots": [{"at": 0, "colour": [0, 0, 0], "opacity": 0},
                                             {"at": 1, "colour": [1, 1, 1], "opacity": 0.1}]})"));
  std::filesystem::copy(file, folder_.file("plain"));
  ASSERT_EQ(render(folder_.file("plain") + " --volume-size 24 24 24 --type f64 --transfer-function " +
                   control_points + common)
                .status,
            0);
  EXPECT_EQ(difference(read_image(folder_.file("f.pfm")), expected).max, 0);
  // 16 bits over the range of values are almost as exact as floats.
  ASSERT_EQ(render(file + " --texels u16 --range=-0.34,1.67" + common).status, 0);
  const double apart = difference(read_image(folder_.file("f.pfm")), expected).max;
  EXPECT_GT(apart, 0);
  EXPECT_LT(apart, 2e-3);
}

TEST_F(Render, LoadingIsShown) {
  const Result result = render("synthetic:200x300x800:u8:shells --size 20x20 --progress");
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("loading   0 %"), HasSubstr("loading 100 %"), HasSubstr("by 1 rank")));
  int last = -1, lines = 0;
  for (std::size_t at = 0; (at = result.output.find("loading ", at)) != std::string::npos; at += 8, ++lines) {
    const int percent = std::stoi(result.output.substr(at + 8, 3));
    EXPECT_GE(percent, last);
    last = percent;
  }
  EXPECT_GE(lines, 3) << "a line for every tenth, in steps of some MiB";
  EXPECT_THAT(render("synthetic:8x8x8 --size 20x20").output, Not(HasSubstr("loading"))) << "no terminal";
  EXPECT_EQ(render("synthetic:8x8x8 --size 20x20 --quiet").output, "");
}

TEST_F(Render, WhatIsWrongIsSaidWithTheNextStep) {
  const std::string file = ball(8);
  const auto trouble = [&](const std::string& arguments) {
    const Result result = render(arguments);
    EXPECT_NE(result.status, 0) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_.file("p.png"))) << arguments;
    return result.output;
  };
  const auto table = [&](const std::string& control_points) {
    return file + " --transfer-function " + folder_.write("t.json", control_points);
  };
  EXPECT_THAT(trouble(folder_.file("nothing_8x8x8.raw")), HasSubstr("check the path"));
  EXPECT_THAT(trouble(folder_.write("short_9x9x9_u8.raw", std::string(700, 'x'))), HasSubstr("truncated"));
  EXPECT_THAT(trouble(file + " --transfer-function nothing"), HasSubstr("grey, engine, ct"));
  EXPECT_THAT(trouble(table("{")), HasSubstr("not a transfer function"));
  EXPECT_THAT(trouble(table("{}")), HasSubstr("list 'knots' is missing"));
  EXPECT_THAT(trouble(table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": 0}]})")),
              HasSubstr("too few"));
  EXPECT_THAT(trouble(table(R"({"knots": [{"at": 1, "colour": [0,0,0], "opacity": 0},
                                          {"at": 0, "colour": [0,0,0], "opacity": 0}]})")),
              HasSubstr("sort them"));
  EXPECT_THAT(trouble(table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": null}]})")),
              HasSubstr("control point 1: 'opacity' is missing or not a number"));
  EXPECT_THAT(trouble(table(R"({"knots": [{"at": 0, "colour": [0,0,0], "opacity": 0},
                                          {"at": 1, "colour": [0,0,0], "opacity": -1}]})")),
              HasSubstr("opacity is -1"));
  EXPECT_THAT(trouble(file + " --camera 10,20"), HasSubstr("30,20,4"));
  EXPECT_THAT(trouble(file + " --camera 10,20,4,0,0"), HasSubstr("30,20,4"));
  EXPECT_THAT(trouble(file + " --camera 10,200,4"), HasSubstr("-90 to 90"));
  EXPECT_THAT(trouble(file + " --size 100"), HasSubstr("512x512"));
  EXPECT_THAT(trouble(file + " --size 0x10"), HasSubstr("each side"));
  EXPECT_THAT(trouble(file + " --step 0"), HasSubstr("positive"));
  EXPECT_THAT(trouble(file + " --texels u8"), HasSubstr("--range"));
  EXPECT_THAT(trouble("synthetic:8x8"), HasSubstr("synthetic:512x512x512:u8:shells"));
  EXPECT_THAT(trouble(file + " --error-bound --pixels half"), HasSubstr("give --pixels float"));
  EXPECT_THAT(trouble(file + " --error-bound --pixels byte"), HasSubstr("give --pixels float"));
  EXPECT_THAT(trouble(file + " --error-bound --quality 90"), HasSubstr("leave out --quality"));
}

TEST_F(Render, AnErrorIsCertifiedWithTheBound) {
  const std::string common =
      ball(16) + " --size 24x20 --save-float " + folder_.file("f.pfm") + " --report " + folder_.file("r.json");
  ASSERT_EQ(render(common + " --termination 0 --step 0.01").status, 0);
  const RgbaImage converged = read_image(folder_.file("f.pfm"));
  for (const double asked : {0.05, 0.005}) {
    const Result result = render(common + " --error-bound --error " + std::to_string(asked));
    ASSERT_EQ(result.status, 0) << result.output;
    const Json bound = report()["error_bound"];
    EXPECT_EQ(bound["asked"], asked);
    EXPECT_LE(bound["greatest"], asked);
    EXPECT_TRUE(report()["budget"].is_null()) << "nothing was estimated";
    EXPECT_THAT(result.output, HasSubstr("(asked: "));
    const Difference apart = difference(read_image(folder_.file("f.pfm")), converged);
    std::printf("asked %g, certified %g at a step of %g, %g from the converged image\n", asked,
                bound["greatest"].get<double>(), report()["image"]["step"].get<double>(), apart.max);
    EXPECT_LE(apart.max, bound["greatest"].get<double>());
  }
}

TEST_F(Render, AnErrorThatCannotBeCertifiedIsRefusedWithTheBound) {
  const Result result = render(ball(8) + " --size 6x5 --error-bound --error 1e-7");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.output, HasSubstr("an error of 1e-07 cannot be certified"));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("p.png")));
}

#ifdef UNDERSTUDY_HAS_NODES

TEST_F(Render, NodesGiveTheImageOfOneProcessAndReadTheirSharesAlone) {
  const std::string file = ball(48), common = file + " --transfer-function rainbow --size 90x80 --save-float " +
                                              folder_.file("f.pfm") + " --report " + folder_.file("r.json");
  ASSERT_EQ(render(common).status, 0);
  const RgbaImage expected = read_image(folder_.file("f.pfm"));
  for (const int nodes : {1, 2, 4}) {
    const Result result = render(common + " --sort last -n " + std::to_string(nodes));
    ASSERT_EQ(result.status, 0) << result.output;
    const Difference apart = difference(read_image(folder_.file("f.pfm")), expected);
    std::printf("%d nodes: at most %.1e apart\n", nodes, apart.max);
    EXPECT_LE(apart.max, 1e-5) << nodes;
    const Json json = report();
    EXPECT_EQ(json["nodes"], nodes);
    ASSERT_EQ(json["ranks"].size(), std::size_t(nodes));
    constexpr double all = 48.0 * 48 * 48 * 8;
    double sum = 0;
    for (const Json& rank : json["ranks"]) {
      EXPECT_LE(double(rank["bytes_read"]), 1.35 * all / nodes + 4);
      sum += double(rank["bytes_read"]);
    }
    EXPECT_GE(sum, all);
  }
}

TEST_F(Render, NodesThatDivideTheImageReadTheFileOnce) {
  const std::string common = ball(128) + " --transfer-function rainbow --size 90x80 --save-float " +
                             folder_.file("f.pfm") + " --report " + folder_.file("r.json");
  ASSERT_EQ(render(common).status, 0);
  const RgbaImage expected = read_image(folder_.file("f.pfm"));
  const std::uint64_t samples = report()["samples_taken"];
  for (const char* sort : {"", " --sort first"}) {
    const Result result = render(common + " -n 4" + sort);
    ASSERT_EQ(result.status, 0) << result.output;
    EXPECT_EQ(difference(read_image(folder_.file("f.pfm")), expected).max, 0);
    const Json json = report();
    EXPECT_EQ(json["samples_taken"], samples);
    ASSERT_EQ(json["ranks"].size(), 4U);
    EXPECT_GE(json["ranks"][0]["bytes_read"], 128 * 128 * 128 * 8);
    for (std::size_t rank = 1; rank < 4; ++rank) {
      EXPECT_LT(json["ranks"][rank]["bytes_read"], 4096);
      EXPECT_LT(10 * json["ranks"][rank]["brick_bytes"].get<std::uint64_t>(), json["ranks"][0]["brick_bytes"]);
      EXPECT_GT(json["ranks"][rank]["samples_taken"], 0);
    }
  }
}

// The launcher never reads the end of the file, so only the nodes detect the error.
TEST_F(Render, WhatANodeFindsWrongIsSaid) {
  const std::string name = folder_.write("half_60x60x60_u8.raw", std::string(60 * 60 * 30, 'x'));
  ASSERT_EQ(shell("gzip " + name).status, 0);
  const Result result = render(name + ".gz -n 2");
  EXPECT_EQ(result.status, 1) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("half_60x60x60_u8.raw.gz"), HasSubstr("truncated")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("p.png")));
}

#endif

}  // namespace
}  // namespace understudy::launcher
