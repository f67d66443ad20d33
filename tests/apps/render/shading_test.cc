// SPDX-License-Identifier: Apache-2.0
// Surfaces, light and pre-integrated segments of `understudy render`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/render/render_command.h"

namespace understudy::launcher {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A 16-bit ball that is brightest in its middle: value v lies at a radius of (1 - v / 60000) half sides.
std::string cone(const TemporaryFolder& folder, int side) {
  std::vector<std::uint16_t> values;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double r =
            2 * std::hypot(x + 0.5 - side / 2.0, y + 0.5 - side / 2.0, z + 0.5 - side / 2.0) / side;
        values.push_back(std::uint16_t(60000 * std::max(0.0, 1 - r)));
      }
  const std::string edge = std::to_string(side);
  return folder.write("cone_" + edge + "x" + edge + "x" + edge + "_u16.raw", std::as_bytes(std::span(values)));
}

constexpr const char* view = " --size 80x80 --camera 0,0,4";

TEST_F(Render, ASurfaceLiesWhereTheValueIs) {
  const RgbaImage image = this->image(cone(folder_, 40) + " --no-volume --surface 30000,#ff8000" + view);
  // In units of half the volume's diagonal, half a side of the ball is 1 / sqrt(3), the eye is at distance 4,
  // and the image shows 2 * 4 * tan(15 degrees). The surface at half of the half side has a silhouette of 10.8
  // pixels.
  const double half = 0.5 / std::sqrt(3.0);
  const double radius = 40 * half / std::sqrt(16 - half * half) / std::tan(std::numbers::pi / 12);
  for (int x = 0; x < 80; ++x) {
    const double away = std::abs(x + 0.5 - 40);
    if (std::abs(away - radius) < 0.7) continue;
    const bool inside = away < radius;
    EXPECT_NEAR(image.pixel(x, 40)[0], inside ? 1 : 0, 1e-5) << x;
    EXPECT_NEAR(image.pixel(x, 40)[1], inside ? 128.0 / 255 : 0, 1e-5) << x;
    EXPECT_NEAR(image.pixel(x, 40)[3], inside ? 1 : 0, 1e-5) << x;
  }
}

TEST_F(Render, APlaceInTheRangeIsAValue) {
  const std::string file = cone(folder_, 20);
  const RgbaImage by_place =
      image(file + " --no-volume --surface 40%,c0c0c0,0.5 --report " + folder_.file("r.json") + view);
  const Json surface = report()["image"]["surfaces"][0], values = report()["volume"]["values"];
  EXPECT_NEAR(double(surface["value"]), double(values[0]) + 0.4 * (double(values[1]) - double(values[0])), 0.1);
  EXPECT_EQ(surface["colour"][3], 0.5);
  EXPECT_EQ(report()["image"]["method"], "post-classified");
  EXPECT_EQ(report()["image"]["light"], "none");
  const RgbaImage by_value =
      image(file + " --no-volume --surface " + surface["value"].dump() + ",c0c0c0,0.5" + view);
  EXPECT_LE(difference(by_place, by_value).max, 1e-6);
  EXPECT_NEAR(by_place.pixel(40, 40)[3], 0.75, 1e-5) << "in through half of it, and out through half of it";
}

TEST_F(Render, LightFallsOnWhatItIsMeantFor) {
  const std::string surface = cone(folder_, 40) + " --no-volume --surface 30000 --material 0.1,0.9,0,1" + view;
  const RgbaImage head_light = image(surface + " --light all");
  EXPECT_GT(head_light.pixel(40, 40)[0], 0.85F) << "it faces the eye";
  EXPECT_LT(head_light.pixel(50, 40)[0], 0.6F) << "it is nearly seen from the side";
  const RgbaImage from_the_right = image(surface + " --light-from 90,0");
  EXPECT_GT(from_the_right.pixel(48, 40)[0], from_the_right.pixel(41, 40)[0] + 0.3F);
  // The same on both sides: a surface is also lit from behind.
  EXPECT_NEAR(from_the_right.pixel(48, 40)[0], from_the_right.pixel(31, 40)[0], 0.02);

  const std::string both = cone(folder_, 40) + " --transfer-function grey --surface 45000" + view;
  const RgbaImage dark = image(both), surfaces = image(both + " --light surfaces"),
                  all = image(both + " --light all");
  const auto apart = [](const RgbaImage& a, const RgbaImage& b, int x) {
    return std::abs(a.pixel(x, 40)[0] - b.pixel(x, 40)[0]);
  };
  EXPECT_GT(apart(dark, surfaces, 43), 1e-3F) << "before the surface";
  EXPECT_EQ(apart(dark, surfaces, 50), 0) << "beside it there is the volume alone";
  EXPECT_GT(apart(dark, all, 50), 1e-2F);
}

TEST_F(Render, SegmentsNeedFewerStepsThanSamples) {
  const std::string control_points = folder_.write("spikes.json", std::string(R"({"knots": [
          {"at": 0, "colour": [1, 0, 0], "opacity": 0}, {"at": 0.30, "colour": [1, 0, 0], "opacity": 0},
          {"at": 0.32, "colour": [1, 0.5, 0], "opacity": 0.6}, {"at": 0.34, "colour": [1, 0, 0], "opacity": 0},
          {"at": 0.60, "colour": [0, 0, 1], "opacity": 0}, {"at": 0.62, "colour": [0, 0.5, 1], "opacity": 0.6},
          {"at": 0.64, "colour": [0, 0, 1], "opacity": 0}, {"at": 1, "colour": [0, 0, 1], "opacity": 0}]})"));
  const std::string common = cone(folder_, 32) + " --transfer-function " + control_points + view;
  const RgbaImage fine = image(common + " --step 0.02"), samples = image(common + " --step 1"),
                  segments = image(common + " --step 1 --method pre-integrated");
  const double by_samples = difference(samples, fine).rms, by_segments = difference(segments, fine).rms;
  std::printf("rms error of samples %.2e, of segments %.2e\n", by_samples, by_segments);
  EXPECT_LT(by_segments, by_samples / 4);
}

TEST_F(Render, SegmentsLeaveATableThatDoesNotSpanTheVolume) {
  const std::string control_points = folder_.write("narrow.json", std::string(R"({"positions": "values",
                                     "knots": [{"at": 30000, "colour": [1, 0.5, 0], "opacity": 0},
                                               {"at": 31000, "colour": [1, 1, 0.5], "opacity": 0.5}]})"));
  const std::string common = cone(folder_, 32) + " --transfer-function " + control_points + view;
  const RgbaImage fine = image(common + " --step 0.02");
  const double by_samples = difference(image(common + " --step 1"), fine).rms,
               by_segments = difference(image(common + " --step 1 --method pre-integrated"), fine).rms;
  std::printf("rms error of samples %.2e, of segments %.2e\n", by_samples, by_segments);
  EXPECT_GT(fine.pixel(40, 40)[3], 0.99F);
  EXPECT_LT(by_segments, by_samples / 4);
}

TEST_F(Render, AdaptiveStepsAreNearerThanSamplesAsMany) {
  const std::string control_points = folder_.write("spike.json", std::string(R"({"knots": [
          {"at": 0, "colour": [1, 0, 0], "opacity": 0}, {"at": 0.60, "colour": [1, 0, 0], "opacity": 0},
          {"at": 0.62, "colour": [1, 0.5, 0], "opacity": 0.6}, {"at": 0.64, "colour": [1, 0, 0], "opacity": 0},
          {"at": 1, "colour": [0, 0, 1], "opacity": 0}]})"));
  const std::string common = cone(folder_, 64) + " --transfer-function " + control_points + view +
                             " --report " + folder_.file("r.json");
  const RgbaImage fine = image(common + " --step 0.02");
  const RgbaImage adaptive = image(common + " --step 1 --method adaptive --tolerance 0.01");
  EXPECT_EQ(report()["image"]["method"], "adaptive");
  const double taken = report()["samples_taken"];
  const RgbaImage samples = image(common + " --step 0.1");
  std::printf("rms error of adaptive steps %.2e with %g samples, of samples %.2e with %g\n",
              difference(adaptive, fine).rms, taken, difference(samples, fine).rms,
              double(report()["samples_taken"]));
  EXPECT_LE(taken, double(report()["samples_taken"]));
  EXPECT_LT(difference(adaptive, fine).rms, 2 * difference(samples, fine).rms);
}

TEST_F(Render, AFirstHitIsOpaqueAndInTheTablesColour) {
  const std::string control_points = folder_.write("red.json", std::string(R"({"knots": [
          {"at": 0, "colour": [1, 0.5, 0], "opacity": 0}, {"at": 0.5, "colour": [1, 0.5, 0], "opacity": 0},
          {"at": 1, "colour": [1, 0.5, 0], "opacity": 0.01}]})"));
  const std::string common = cone(folder_, 40) + " --transfer-function " + control_points + view;
  for (const char* const ranks : {"", " -n 4"}) {
    const RgbaImage hit = image(common + " --operator first-hit" + ranks);
    EXPECT_NEAR(hit.pixel(40, 40)[0], 1, 1e-4);
    EXPECT_NEAR(hit.pixel(40, 40)[1], 0.5, 1e-4);
    EXPECT_EQ(hit.pixel(40, 40)[3], 1);
    EXPECT_EQ(hit.pixel(1, 1)[3], 0);
  }
  EXPECT_LT(image(common).pixel(40, 40)[3], 0.5F) << "composed, it is thin";
}

TEST_F(Render, ShadingWithoutSenseIsRefusedWithTheNextStep) {
  const std::string file = cone(folder_, 8);
  const auto trouble = [&](const std::string& arguments) {
    const Result result = render(file + " " + arguments);
    EXPECT_NE(result.status, 0) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_.file("p.png"))) << arguments;
    return result.output;
  };
  EXPECT_THAT(trouble("--method adaptive --light all"), HasSubstr("pre-integrated"));
  EXPECT_THAT(trouble("--operator first-hit --light all"), HasSubstr("leave out"));
  EXPECT_THAT(trouble("--operator sum"), HasSubstr("first-hit"));
  EXPECT_THAT(trouble("--surface x"), AllOf(HasSubstr("not a number"), HasSubstr("40%,#e8c090,0.5")));
  EXPECT_THAT(trouble("--surface ''"), HasSubstr("not a number"));
  EXPECT_THAT(trouble("--surface nan"), HasSubstr("not a number"));
  EXPECT_THAT(trouble("--surface 0%"), HasSubstr("above 0% and at most 100%"));
  EXPECT_THAT(trouble("--surface 70000"), AllOf(HasSubstr("range from 0 to"), HasSubstr("40%")));
  EXPECT_THAT(trouble("--surface 9,blue"), HasSubstr("#rrggbb"));
  EXPECT_THAT(trouble("--surface 9,12345"), HasSubstr("#rrggbb"));
  EXPECT_THAT(trouble("--surface 9,123456,2"), HasSubstr("opacity"));
  EXPECT_THAT(trouble("--surface 9,123456,1,1"), HasSubstr("three parts"));
  std::string many;
  for (int i = 1; i <= 17; ++i) many += " --surface " + std::to_string(i) + "%";
  EXPECT_THAT(trouble(many), HasSubstr("at most 16"));
  EXPECT_THAT(trouble("--no-volume"), HasSubstr("give a --surface"));
  EXPECT_THAT(trouble("--light surfaces"), HasSubstr("--light all"));
  EXPECT_THAT(trouble("--light sun"), HasSubstr("surfaces"));
  EXPECT_THAT(trouble("--light-from 10,100"), HasSubstr("-90 to 90"));
  EXPECT_THAT(trouble("--light-from 10"), HasSubstr("45,60"));
  EXPECT_THAT(trouble("--material 1,1,1,1"), HasSubstr("give --light all"));
  EXPECT_THAT(trouble("--light all --material 1,-1,1,1"), HasSubstr("0 to 10000"));
  EXPECT_THAT(trouble("--light all --material 1,1"), HasSubstr("0.2,0.8,0.3,20"));
  EXPECT_THAT(trouble("--method volumetric"), HasSubstr("pre-integrated"));
  EXPECT_THAT(trouble("--method pre-integrated --step 100"), HasSubstr("smaller"));
  EXPECT_THAT(trouble("--cut-at-bricks 16"), HasSubstr("--method pre-integrated"));
  EXPECT_THAT(trouble("--cut-at-bricks 12 --method pre-integrated"), HasSubstr("a multiple of 8"));
  EXPECT_THAT(trouble("--backend gl"), AllOf(HasSubstr("-n N"), HasSubstr("serve")));
}

TEST_F(Render, CutsSegmentsAtBricksWhereAskedTo) {
  const std::string common =
      ball(48) + " --transfer-function rainbow --method pre-integrated --size 90x80 --step 2";
  const RgbaImage seamless = image(common);
  EXPECT_EQ(difference(image(common + " --cut-at-bricks 64"), seamless).max, 0) << "it is one brick";
  const double few = difference(image(common + " --cut-at-bricks 24"), seamless).max,
               many = difference(image(common + " --cut-at-bricks 8"), seamless).max;
  std::printf("cut at bricks of 24 and of 8: %.1e and %.1e from uncut\n", few, many);
  EXPECT_GT(few, 1e-5);
  EXPECT_GT(many, 1e-5);
  EXPECT_LT(many, 0.1);
}

#ifdef UNDERSTUDY_HAS_NODES

TEST_F(Render, NodesShowTheSameSurfacesLightAndSegments) {
  const std::string file = ball(48);
  for (const char* shading :
       {" --no-volume --surface 60%,#ffffff,0.7 --light all",
        " --transfer-function rainbow --method pre-integrated --light all --light-from 20,50",
        " --transfer-function vessels --surface 70%,#4060ff,0.4 --surface 20%,#ff8040,0.2 --light surfaces "
        "--step 1.7"}) {
    const std::string common = file + shading + " --size 90x80";
    const RgbaImage expected = image(common);
    for (const char* nodes : {" -n 2", " -n 3 --sort last --exchange binary-swap"}) {
      const Difference apart = difference(image(common + nodes), expected);
      std::printf("%s%s: rms %.1e, at most %.1e apart\n", shading, nodes, apart.rms, apart.max);
      EXPECT_LE(apart.max, 1e-4) << shading << nodes;
    }
    EXPECT_GT(difference(image(common + " -n 2 --sort last --pixels byte"), expected).max, 1e-4)
        << "pixels are options too";
  }
}

TEST_F(Render, WhatOpenGlDoesNotDrawIsSaid) {
  const std::string common = ball(24) + " --size 40x40 -n 1 --backend gl --report " + folder_.file("r.json");
  const Result samples = render(common), surfaces = render(common + " --surface 50%");
  ASSERT_EQ(samples.status, 0) << samples.output;
  ASSERT_EQ(surfaces.status, 0) << surfaces.output;
  EXPECT_THAT(samples.output, AllOf(HasSubstr("node 0: "), Not(HasSubstr("does not draw"))));
  if (samples.output.find("GL, as asked") == std::string::npos) GTEST_SKIP() << samples.output;
  EXPECT_THAT(surfaces.output, HasSubstr("node 0: CPU: the GL backend does not draw surfaces"));
  EXPECT_THAT(report()["backends"].dump(), HasSubstr("does not draw surfaces"));
}

#endif

}  // namespace
}  // namespace understudy::launcher
