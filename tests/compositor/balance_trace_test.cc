// SPDX-License-Identifier: Apache-2.0
// Whole runs with each balancer, whose samples are really cast and counted: what the benchmark shows with
// volumes from files, with fields that need no file.
#include "apps/bench/balance_trace.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "tests/volume/fields.h"
#include "tests/volume/scenes.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/segment_scene.h"
#include "volume/request.h"

namespace understudy::bench {
namespace {

using compositor::Balance;
using compositor::make_balancer;

/// A helix of vessels in one corner of an empty volume.
double vessels(const volume::Vec3& t) {
  const double angle = 14 * t[2];
  const double x = t[0] - 0.28 - 0.16 * std::cos(angle), y = t[1] - 0.34 - 0.16 * std::sin(angle);
  return std::exp(-(x * x + y * y) / 0.0015) + 0.5 * std::exp(-(x * x + y * y) / 0.01) * (t[2] < 0.6 ? 1 : 0);
}

volume::TransferFunction table(double from, float opacity) {
  volume::TransferFunction table;
  for (int i = 0; i < 256; ++i) {
    const float v = float(i) / 255, a = double(v) < from ? 0 : opacity * v;
    table.entries.push_back({v * a, a, (1 - v) * a, a});
  }
  return table;
}

/// `vary` may change the request of an image.
TraceScene scene_of(const volume::testing::ScalarField& field,
                    std::function<void(int, volume::OrbitCamera&, volume::RenderRequest&)> vary,
                    bool slowed = false) {
  TraceScene scene;
  scene.description = volume::testing::describe({113, 97, 105}, volume::TexelType::u8);
  scene.description.ghost_layer = 1;
  scene.images = 80;
  scene.seed = 2501;
  scene.transfer_latency_ms = 0.005;  // images are small here
  const auto texture =
      std::make_shared<volume::testing::Texture>(volume::testing::sampled(scene.description, field));
  scene.texels = [texture](std::uint64_t) { return texture->texels; };
  scene.request = [vary = std::move(vary), description = scene.description](int image) {
    volume::OrbitCamera camera;
    camera.azimuth = 30 + 0.5 * image;
    volume::RenderRequest settings;  // holds what is varied besides the camera
    settings.classification = table(0.15, 0.05F);
    vary(image, camera, settings);
    volume::RenderRequest request = volume::orbit_request(description, {1, 1, 1}, camera, 128, 128, 1);
    request.classification = settings.classification;
    request.surfaces = settings.surfaces;
    request.light = settings.light;
    return request;
  };
  if (slowed) {
    scene.relative_cost = [](int image, int rank) { return rank == 2 && image >= 20 ? 4.0 : 1.0; };
    scene.events = {0, 20};
  }
  return scene;
}

struct Sums {
  TraceSums still, muller, predicted;
};

/// Plays all three balancers, prints the results, and checks what the predicting one promises everywhere: it
/// takes less time than the others, or at most `of_mullers` times that of Mueller's.
Sums play(const char* name, TraceScene scene, double of_mullers = 1) {
  TracePlayer player(std::move(scene));
  Sums sums;
  for (const auto& [balance, into] : {std::pair{Balance::off, &sums.still},
                                      {Balance::muller, &sums.muller},
                                      {Balance::predicted, &sums.predicted}}) {
    const auto balancer = make_balancer(balance);
    *into = player.sums(player.play(balancer.get()));
    std::printf(
        "%s, seed %u: %.3f ms (ideal %.3f), deviation %.2f, at the end %.2f, %.2f MB, %d planes, %d back\n",
        name, player.scene().seed, into->mean_ms, into->ideal_ms, into->mean_deviation, into->end_deviation,
        into->bytes / 1e6, into->planes_moved, into->reversals);
  }
  EXPECT_LT(sums.predicted.mean_ms, sums.still.mean_ms) << name;
  EXPECT_LT(sums.predicted.mean_ms, of_mullers * sums.muller.mean_ms) << name;
  EXPECT_LT(sums.predicted.mean_deviation, sums.still.mean_deviation) << name;
  return sums;
}

TEST(BalanceTrace, SparseVolume) {
  const Sums sums = play("sparse", scene_of(vessels, [](int, volume::OrbitCamera&, volume::RenderRequest&) {}));
  EXPECT_LT(sums.predicted.mean_ms, 0.7 * sums.still.mean_ms);
}

TEST(BalanceTrace, RankSlowedToAQuarterUnderSurfacesVolumesAndLight) {
  const auto ball = volume::testing::sphere_field(0.4, 0.15);
  const Sums surface =
      play("slowed, surface", scene_of(
                                  ball,
                                  [](int, volume::OrbitCamera&, volume::RenderRequest& request) {
                                    request.classification = table(2, 0);
                                    request.surfaces = {{0.5, {1, 1, 1, 1}}};
                                  },
                                  true));
  EXPECT_LT(surface.predicted.mean_ms, 0.8 * surface.still.mean_ms);
  // One of fourteen layers is a fourteenth of the work: moving by one is as good here as a prediction.
  const Sums bare = play("slowed, volume",
                         scene_of(
                             ball, [](int, volume::OrbitCamera&, volume::RenderRequest&) {}, true),
                         1.03);
  EXPECT_LT(bare.predicted.mean_ms, 0.7 * bare.still.mean_ms);
  const Sums lit =
      play("slowed, lit",
           scene_of(
               ball, [](int, volume::OrbitCamera&, volume::RenderRequest& request) { request.light.emplace(); },
               true));
  EXPECT_LT(lit.predicted.mean_ms, 0.7 * lit.still.mean_ms);
}

TEST(BalanceTrace, TransferFunctionSwitched) {
  // Layers: one transfer function shows the lower ones, the other the upper ones.
  const auto rising = volume::testing::linear_field({0.1, 0.05, 0.8}, 0);
  TraceScene scene = scene_of(rising, [](int image, volume::OrbitCamera&, volume::RenderRequest& request) {
    volume::TransferFunction only = table(0, 0.02F);
    const bool above = image / 20 % 2 == 1;
    for (std::size_t i = 0; i < only.entries.size(); ++i)
      if ((i > 120) != above) only.entries[i] = {};
    request.classification = only;
  });
  scene.events = {0, 20, 40, 60};
  const Sums sums = play("switched", std::move(scene));
  EXPECT_LT(sums.predicted.mean_ms, 0.8 * sums.still.mean_ms);
  EXPECT_LE(sums.predicted.settling, 3);
}

TEST(BalanceTrace, CameraThatZooms) {
  play("zooming", scene_of(volume::testing::marschner_lobb_field(),
                           [](int image, volume::OrbitCamera& camera, volume::RenderRequest&) {
                             camera.azimuth = 30;
                             camera.distance = 2.3 + 1.5 * std::cos(image * 0.157);
                           }));
}

TEST(BalanceTrace, NothingMovesWhereNothingIsToBeGained) {
  TraceScene scene =
      scene_of(volume::testing::constant_field(0.6),
               [](int, volume::OrbitCamera& camera, volume::RenderRequest&) { camera.azimuth = 0; });
  scene.ranks = 2;
  TracePlayer player(std::move(scene));
  const auto balancer = make_balancer(Balance::predicted);
  const TraceSums sums = player.sums(player.play(balancer.get()));
  EXPECT_LE(sums.planes_moved, 1);
  EXPECT_EQ(sums.reversals, 0);
}

}  // namespace
}  // namespace understudy::bench
