// SPDX-License-Identifier: Apache-2.0
// Time steps as volumes of one service: what was shown last stays, what comes next is read ahead, and memory is
// held.
#include "apps/understudy/file_scene/time_steps.h"

#include <gtest/gtest.h>

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

/// Bytes that a step takes.
std::uint64_t bytes_of_one(const FileScene& scene) {
  const auto service = compositor::embedded_loading_service();
  std::uint64_t bytes = 0;
  TimeSteps(*service, scene, 0).show(0, [&](const std::vector<compositor::RankLoad>& ranks) {
    bytes = ranks.front().brick_bytes;
  });
  return bytes;
}

/// That the service has exactly this step, complete.
bool can_be_drawn(compositor::LoadingService& service, const FileScene& scene, int step) {
  volume::TexelFigures values;
  values.low = 0;
  values.high = 255;
  volume::RenderRequest request = request_of(scene, scene.image, values);
  request.volume = scene.load_of(step).volume.id;
  try {
    service.render(request);
    return true;
  } catch (const compositor::RequestRefused&) {
    return false;
  }
}

TEST(TimeSteps, StayAsFarAsMemoryAllows) {
  const FileScene scene = some_series();
  const std::uint64_t one = bytes_of_one(scene);
  for (const int room : {1, 2, 3, 5}) {
    const auto service = compositor::embedded_loading_service();
    TimeSteps steps(*service, scene, std::uint64_t(double(one) * (room + 0.5)));
    for (const int step : {0, 1, 2, 3, 4, 3, 2}) {
      steps.show(step, [](const std::vector<compositor::RankLoad>&) {});
      EXPECT_EQ(steps.shown(), step);
      EXPECT_TRUE(can_be_drawn(*service, scene, step));
      EXPECT_LE(steps.loaded(), std::size_t(room)) << step;
    }
    EXPECT_EQ(steps.loaded(), std::size_t(std::min(room, steps_in_all)));
    // The last that were shown.
    EXPECT_EQ(can_be_drawn(*service, scene, 3), room > 1);
    EXPECT_EQ(can_be_drawn(*service, scene, 4), room > 2);
    EXPECT_EQ(can_be_drawn(*service, scene, 0), room > 4);
  }
}

TEST(TimeSteps, TheNextIsReadAheadWhereThereIsRoom) {
  const FileScene scene = some_series();
  const std::uint64_t one = bytes_of_one(scene);
  for (const bool room : {false, true}) {
    const auto service = compositor::embedded_loading_service();
    TimeSteps steps(*service, scene, room ? one * 5 / 2 : one * 3 / 2);
    for (const int step : {3, 4}) {
      steps.show(step, [](const std::vector<compositor::RankLoad>&) {});
      while (steps.read_ahead()) {
      }
      EXPECT_EQ(can_be_drawn(*service, scene, (step + 1) % steps_in_all), room);
      EXPECT_TRUE(can_be_drawn(*service, scene, step)) << "what is shown stays";
    }
  }
}

TEST(TimeSteps, AFileThatCannotBeReadSpoilsNoOther) {
  FileScene scene = some_series();
  scene.series[1] = "/no/such/file.raw";
  const auto service = compositor::embedded_loading_service();
  TimeSteps steps(*service, scene, std::numeric_limits<std::uint64_t>::max());
  const auto nothing = [](const std::vector<compositor::RankLoad>&) {};
  steps.show(0, nothing);
  EXPECT_THROW(steps.read_ahead(), compositor::RequestRefused);
  EXPECT_THROW(steps.show(1, nothing), compositor::RequestRefused);
  EXPECT_EQ(steps.shown(), 0);
  steps.show(2, nothing);
  EXPECT_TRUE(can_be_drawn(*service, scene, 0));
  EXPECT_TRUE(can_be_drawn(*service, scene, 2));
}

}  // namespace
}  // namespace understudy::launcher
