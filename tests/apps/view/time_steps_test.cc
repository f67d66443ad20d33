// SPDX-License-Identifier: Apache-2.0
// Time steps as volumes of one service: the most recently shown steps stay loaded, the next one is read ahead,
// and the memory limit is kept.
#include "apps/understudy/file_scene/time_steps.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "compositor/rendered.h"

namespace understudy::launcher {
namespace {

constexpr int steps_in_all = 5;

FileScene some_series() {
  SceneArguments arguments;
  for (const char* field : {"lobes", "gyroid", "lobes", "gyroid", "lobes"})
    arguments.volumes.push_back(std::string("synthetic:60x50x40:u8:") + field);
  arguments.size = "32x32";
  return scene_of(arguments);
}

void ignore(const std::vector<compositor::RankLoad>& /*ranks*/) {}

constexpr VolumeMemory unlimited{std::numeric_limits<std::uint64_t>::max(), false};

/// Bytes that one step occupies.
std::uint64_t bytes_of_one(const FileScene& scene) {
  const auto service = compositor::embedded_loading_service();
  std::uint64_t bytes = 0;
  TimeSteps(*service, scene, unlimited).show(0, [&](const std::vector<compositor::RankLoad>& ranks) {
    bytes = ranks.front().brick_bytes;
  });
  return bytes;
}

/// The service's image of this step; empty if the step is not loaded completely.
std::vector<float> image_of(compositor::LoadingService& service, const FileScene& scene, int step) {
  volume::TexelFigures values;
  values.low = 0;
  values.high = 255;
  volume::RenderRequest request = request_of(scene, scene.image, values);
  request.volume = scene.load_of(step).volume.id;
  try {
    const compositor::Rendered rendered = service.render(request);
    return {rendered.image.rgba.begin(), rendered.image.rgba.end()};
  } catch (const compositor::RequestRefused&) {
    return {};
  }
}

/// Odd steps show one field, even steps another.
TEST(TimeSteps, StayAsFarAsMemoryAllows) {
  const FileScene scene = some_series();
  const std::uint64_t one = bytes_of_one(scene);
  const auto whole = compositor::embedded_loading_service();
  TimeSteps all(*whole, scene, unlimited);
  all.show(1, ignore);
  all.show(0, ignore);
  const std::array expected{image_of(*whole, scene, 0), image_of(*whole, scene, 1)};
  ASSERT_NE(expected[0], expected[1]);
  for (const int room : {1, 2, 3, 5}) {
    const auto service = compositor::embedded_loading_service();
    TimeSteps steps(*service, scene, {std::uint64_t(double(one) * (room + 0.5)), false});
    for (const int step : {0, 1, 2, 3, 4, 3, 2}) {
      steps.show(step, ignore);
      EXPECT_EQ(steps.shown(), step);
      EXPECT_EQ(image_of(*service, scene, step), expected[std::size_t(step % 2)]);
      EXPECT_LE(steps.loaded(), std::size_t(room)) << step;
    }
    EXPECT_EQ(steps.loaded(), std::size_t(std::min(room, steps_in_all)));
    // The steps that were shown last are still loaded.
    EXPECT_EQ(image_of(*service, scene, 3).empty(), room <= 1);
    EXPECT_EQ(image_of(*service, scene, 4).empty(), room <= 2);
    EXPECT_EQ(image_of(*service, scene, 0).empty(), room <= 4);
  }
}

TEST(TimeSteps, TheNextIsReadAheadWhereThereIsRoom) {
  const FileScene scene = some_series();
  const std::uint64_t one = bytes_of_one(scene);
  for (const bool room : {false, true}) {
    const auto service = compositor::embedded_loading_service();
    TimeSteps steps(*service, scene, {room ? one * 5 / 2 : one * 3 / 2, false});
    for (const int step : {3, 4}) {
      steps.show(step, ignore);
      while (steps.read_ahead({})) {
      }
      EXPECT_EQ(image_of(*service, scene, (step + 1) % steps_in_all).empty(), !room);
      EXPECT_FALSE(image_of(*service, scene, step).empty()) << "what is shown stays";
    }
  }
}

TEST(TimeSteps, NothingInUseIsForgottenToReadAhead) {
  const FileScene scene = some_series();
  const std::uint64_t one = bytes_of_one(scene);
  const auto service = compositor::embedded_loading_service();
  TimeSteps steps(*service, scene, {one * 5 / 2, false});
  steps.show(0, ignore);
  steps.show(3, ignore);
  EXPECT_FALSE(steps.read_ahead(std::array{0, 3}));
  EXPECT_FALSE(image_of(*service, scene, 0).empty());
  EXPECT_TRUE(steps.read_ahead(std::array{3}));
  EXPECT_TRUE(image_of(*service, scene, 0).empty());
}

TEST(TimeSteps, AFileThatCannotBeReadSpoilsNoOther) {
  FileScene scene = some_series();
  scene.series[1].file = "/no/such/file.raw";
  const std::uint64_t one = bytes_of_one(scene);
  for (const VolumeMemory& memory : {unlimited, VolumeMemory{one * 3 / 2, false}}) {
    const auto service = compositor::embedded_loading_service();
    TimeSteps steps(*service, scene, memory);
    steps.show(0, ignore);
    EXPECT_FALSE(steps.read_ahead({})) << "it is not spoken of before it is wanted";
    EXPECT_THROW(steps.show(1, ignore), compositor::RequestRefused);
    EXPECT_NE(steps.shown(), 1);
    steps.show(0, ignore);
    EXPECT_FALSE(image_of(*service, scene, 0).empty()) << "whatever was forgotten for the other";
    EXPECT_THROW(steps.show(1, ignore), compositor::RequestRefused);
    steps.show(2, ignore);
    EXPECT_FALSE(image_of(*service, scene, 2).empty());
  }
}

TEST(TimeSteps, WhoStopsReadingGoesOnLater) {
  const FileScene scene = some_series();
  const auto service = compositor::embedded_loading_service();
  TimeSteps steps(*service, scene, unlimited);
  struct Enough {};
  EXPECT_THROW(steps.show(0, [](const std::vector<compositor::RankLoad>&) { throw Enough(); }), Enough);
  steps.show(0, ignore);
  EXPECT_FALSE(image_of(*service, scene, 0).empty());
}

}  // namespace
}  // namespace understudy::launcher
