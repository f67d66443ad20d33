// SPDX-License-Identifier: Apache-2.0
// The parts of `understudy study`: its measurements, and what it stores.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "apps/understudy/study/results.h"

namespace understudy::launcher::study {
namespace {

namespace fs = std::filesystem;

SceneDescription small_scene(const std::string& name) {
  for (SceneDescription scene : built_in_scenes()) {
    if (scene.name != name) continue;
    const std::string kind = scene.volume.substr(scene.volume.find(':', 11));
    scene.volume = "synthetic:24x24x24" + kind;
    return scene;
  }
  throw std::invalid_argument(name);
}

TEST(Study, SmallerStepsComeNearerToTheIntegral) {
  Scene scene(small_scene("thin-fog"), 32, 2);
  int told = 0;
  scene.integrate([&](double done) {
    EXPECT_GT(done, 0);
    EXPECT_LE(done, 1);
    ++told;
  });
  EXPECT_EQ(told, 16 * int(Scene::cameras().size()));
  ASSERT_EQ(scene.exact().size(), 256U * Scene::cameras().size());
  std::vector<Point> points;
  for (const Scheme scheme : {Scheme::post_classified, Scheme::pre_integrated})
    for (const double step : {4.0, 2.0, 1.0, 0.5, 0.25}) {
      Scene::Rays rays;
      points.push_back(measure(scene, {scheme, step, 5e-6}, 1, rays));
      EXPECT_GT(points.back().time_ms, 0);
      if (scheme == Scheme::post_classified) {
        EXPECT_GE(points.back().bound, points.back().error.max);
      }
      EXPECT_GT(points.back().samples_taken, 0U);
      EXPECT_EQ(difference(rays, scene.exact()).rms, points.back().error.rms);
    }
  for (const Scheme scheme : {Scheme::post_classified, Scheme::pre_integrated}) {
    const auto order = observed_order(points, scheme);
    ASSERT_TRUE(order);
    std::printf("%s: order %.2f over steps of %g to %g\n", name_of(scheme), order->slope, order->steps[0],
                order->steps[1]);
    EXPECT_GE(order->slope, 0.8);
  }
  EXPECT_LT(points.back().error.rms, 1e-4);
}

/// Transfer functions for steps other than one voxel describe the medium that the reference integrates.
TEST(Study, StiffScenesComeNearerToTheIntegralAsWell) {
  for (const char* name : {"spikes", "opaque-layers"}) {
    Scene scene(small_scene(name), 32, 2);
    scene.integrate([](double) {});
    EXPECT_GT(scene.stiffness().depth, 0.5) << name;
    EXPECT_GT(scene.stiffness().change, 0.3) << name;
    for (const Scheme scheme : {Scheme::pre_integrated, Scheme::adaptive}) {
      double before = 1;
      for (const double step : {2.0, 1.0, 0.5, 0.25, 0.125}) {
        Scene::Rays rays;
        const double rms = measure(scene, {scheme, step, 5e-6}, 0, rays).error.rms;
        EXPECT_LT(rms, before) << name << ", " << name_of(scheme) << ", step " << step;
        before = rms;
      }
    }
  }
}

TEST(Study, AnOrderIsFittedWhereTheErrorFallsEvenly) {
  std::vector<Point> points;
  for (const auto& [step, rms] :
       {std::pair{8.0, 0.3}, {4.0, 0.29}, {2.0, 0.1}, {1.0, 0.025}, {0.5, 0.00625}, {0.25, 1e-7}})
    points.push_back({{Scheme::adaptive, step, 5e-6}, {rms, rms, rms}});
  const auto order = observed_order(points, Scheme::adaptive);
  ASSERT_TRUE(order);
  EXPECT_NEAR(order->slope, 2, 1e-9);
  EXPECT_NEAR(order->steps[0], 0.5, 1e-9);
  EXPECT_NEAR(order->steps[1], 2, 1e-9);
  EXPECT_FALSE(observed_order(points, Scheme::pre_integrated));
}

TEST(Study, DifferencesHaveQuantilesAndAnInterval) {
  Scene::Rays exact(1000), shown(1000);
  for (std::size_t i = 0; i < shown.size(); ++i) shown[i][i % 4] = double(i) / 1000;
  const Difference found = difference(shown, exact);
  EXPECT_NEAR(found.max, 0.999, 1e-9);
  EXPECT_NEAR(found.quantiles[0], 0.5, 2e-3);
  EXPECT_NEAR(found.quantiles[1], 0.95, 2e-3);
  EXPECT_NEAR(found.quantiles[2], 0.99, 2e-3);
  EXPECT_NEAR(found.rms, std::sqrt(1.0 / 12), 1e-3);
  EXPECT_LT(found.interval[0], found.rms);
  EXPECT_GT(found.interval[1], found.rms);
  EXPECT_NEAR(found.interval[0], found.interval[1], 0.08 * found.rms);
  shown.pop_back();
  EXPECT_THROW(difference(shown, exact), std::invalid_argument);
}

TEST(Study, EightBitsLoseThinFog) {
  Scene scene(small_scene("thin-fog"), 32, 2);
  scene.integrate([](double) {});
  Scene::Rays rays;
  const Point bytes = measure(scene, {Scheme::eight_bit_slices, 1, 0}, 1, rays);
  const Point floats = measure(scene, {Scheme::post_classified, 1, 5e-6}, 1, rays);
  EXPECT_GT(bytes.error.rms, 10 * floats.error.rms);
  EXPECT_EQ(bytes.time_ms, 0) << "emulated: its time says nothing";
}

TEST(Study, TheFrontIsWhatNothingBeats) {
  std::vector<Point> points(4);
  points[0].time_ms = 1, points[0].error.rms = 0.1;
  points[1].time_ms = 2, points[1].error.rms = 0.01;
  points[2].time_ms = 3, points[2].error.rms = 0.02;
  points[3].error.rms = 0;  // not timed
  mark_front(points);
  EXPECT_TRUE(points[0].front);
  EXPECT_TRUE(points[1].front);
  EXPECT_FALSE(points[2].front);
  EXPECT_FALSE(points[3].front);
}

TEST(Study, AdvantagesAreReadOffOurFront) {
  std::vector<Point> points(5);
  points[0].time_ms = 1, points[0].error.colour = 0.1;
  points[1].time_ms = 2, points[1].error.colour = 0.2;  // dominated
  points[2].time_ms = 4, points[2].error.colour = 0.001;
  points[3].setting.scheme = Scheme::bare_viewer;
  points[3].time_ms = 2, points[3].error.colour = 0.01;
  points[4].setting.scheme = Scheme::vtk_gpu;
  points[4].time_ms = 8, points[4].error.colour = 0.5;
  auto advantage = advantage_over(points, Scheme::bare_viewer);
  ASSERT_TRUE(advantage && advantage->time && advantage->error);
  EXPECT_NEAR(advantage->time->value, 1, 1e-9) << "its point lies on our front";
  EXPECT_NEAR(advantage->error->value, 1, 1e-9);
  EXPECT_FALSE(advantage->time->at_least);
  advantage = advantage_over(points, Scheme::vtk_gpu);
  ASSERT_TRUE(advantage && advantage->time && advantage->error);
  EXPECT_NEAR(advantage->time->value, 8, 1e-9);
  EXPECT_TRUE(advantage->time->at_least);
  EXPECT_NEAR(advantage->error->value, 500, 1e-9);
  EXPECT_TRUE(advantage->error->at_least);
  EXPECT_FALSE(advantage_over(points, Scheme::vtk_fixed_point)) << "not measured";
  points[3].time_ms = 0.5, points[3].error.colour = 1e-4;
  advantage = advantage_over(points, Scheme::bare_viewer);
  ASSERT_TRUE(advantage);
  EXPECT_FALSE(advantage->time) << "more exact than all of ours";
  EXPECT_FALSE(advantage->error) << "faster than all of ours";
}

class StudyResults : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / ("understudy-study-" + std::to_string(getpid()));
};

TEST_F(StudyResults, AreReadAgainByAStudyThatGoesOn) {
  Results results{
      64, 4, {{"fog", "thin", "synthetic:8x8x8", {8, 8, 8}, 256, 1.5, {2, 0.5}, {}, {{"a", "a.png"}}, {}}}};
  Point point{{Scheme::pre_integrated, 0.5, 0.01},
              {0.25, 0.125, 0.0625, {0.1, 0.15}, {0.01, 0.02, 0.03}},
              3,
              40,
              10,
              20,
              true,
              {2.5, 3.5},
              0.5};
  results.scenes[0].points = {point};
  write_results(folder, results);
  const Results again = read_results(folder, 64, 4);
  ASSERT_EQ(again.scenes.size(), 1U);
  const SceneResults& scene = again.scenes[0];
  EXPECT_EQ(scene.shows, "thin");
  EXPECT_EQ(scene.error_maps, results.scenes[0].error_maps);
  const Point* found = scene.find(point.setting);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->time_ms, 3);
  EXPECT_EQ(found->error.rms, 0.125);
  EXPECT_EQ(found->error.interval, point.error.interval);
  EXPECT_EQ(found->error.quantiles, point.error.quantiles);
  EXPECT_EQ(found->quartiles, point.quartiles);
  EXPECT_EQ(found->bound, 0.5);
  EXPECT_EQ(scene.stiffness, (Stiffness{2, 0.5}));
  EXPECT_EQ(scene.find({Scheme::post_classified, 0.5, 0.01}), nullptr);
  EXPECT_TRUE(read_results(folder, 128, 4).scenes.empty()) << "images of another size";
  std::ifstream csv(folder / "study.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "scene,scheme,step,termination,rms,rms_low,rms_high,rms_colour,median,p95,p99,max,bound,time_ms,"
            "time_q1_ms,"
            "time_q3_ms,ns_per_ray,samples_taken,samples,depth,change,front");
  std::getline(csv, line);
  EXPECT_EQ(
      line,
      "fog,pre-integrated,0.5,0.01,0.125,0.1,0.15,0.0625,0.01,0.02,0.03,0.25,0.5,3,2.5,3.5,40,10,20,2,0.5,1");
}

TEST_F(StudyResults, AreShownOnAPage) {
  if (std::system("/usr/bin/python3 -c 'import matplotlib' 2>/dev/null") != 0)
    GTEST_SKIP() << "no matplotlib here; apt install python3-matplotlib";
  SceneResults scene{"a<b", "thin", "synthetic:8x8x8",         {8, 8, 8}, 256, 1.5, {},
                     {},    {},     {{"VTK", "not<installed"}}};
  for (const double step : {2.0, 1.0, 0.5, 0.25})
    scene.points.push_back({{Scheme::pre_integrated, step, 5e-6},
                            {step, step * step / 100, step * step / 100},
                            4 / step,
                            40,
                            10,
                            20,
                            true});
  scene.points.push_back({{Scheme::eight_bit_slices, 1, 0}, {0.5, 0.25, 0.25}});
  scene.points.push_back({{Scheme::bare_viewer, 1, 0}, {0.02, 0.01, 0.01}, 40});
  write_results(folder, {64, 4, {scene}});
  ASSERT_EQ(std::system(("/usr/bin/python3 -B " STUDY_PAGE " " + folder.string()).c_str()), 0);
  std::ifstream file(folder / "index.html");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  EXPECT_THAT(page, ::testing::HasSubstr("<h2>a&lt;b</h2>"));
  EXPECT_THAT(page, ::testing::HasSubstr("<td>2.00"));
  EXPECT_THAT(page, ::testing::HasSubstr("<td>10×<td>≥ 16×"))
      << "the bare viewer's time at its error; its error at its time";
  EXPECT_THAT(page, ::testing::HasSubstr("not&lt;installed"));
  EXPECT_THAT(page, ::testing::HasSubstr("data:image/svg+xml;base64,"));
}

TEST_F(StudyResults, ThatAreNoneAreMadeAnew) {
  EXPECT_TRUE(read_results(folder, 64, 4).scenes.empty());
  std::ofstream(folder / "study.json") << "{\"edge\": 64";
  EXPECT_TRUE(read_results(folder, 64, 4).scenes.empty());
}

}  // namespace
}  // namespace understudy::launcher::study
