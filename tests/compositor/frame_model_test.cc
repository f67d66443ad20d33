// SPDX-License-Identifier: Apache-2.0
// Whether modelled images are those of the ray caster, and times follow the model in the header.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "apps/bench/frame_parts.h"
#include "apps/bench/frame_time.h"
#include "tests/volume/scenes.h"
#include "volume/orbit_camera.h"
#include "volume/request.h"

namespace understudy::bench {
namespace {

using compositor::Algorithm;
using compositor::CountedExchange;
using compositor::Gather;
using compositor::Layout;
using volume::testing::Texture;

/// No two extents are equal, none is a multiple of a block; every value shows something.
struct DenseScene {
  Texture texture;
  std::vector<volume::RenderRequest> requests;  ///< samples on steps, and on planes
};

DenseScene dense_scene() {
  DenseScene scene;
  volume::VolumeDescription description = volume::testing::describe({45, 38, 51}, volume::TexelType::u8);
  description.id = 3;
  scene.texture = volume::testing::sampled(description, volume::testing::marschner_lobb_field());
  const volume::VolumeDescription& stored = scene.texture.description;
  for (const double azimuth : {30.0, 200.0})
    scene.requests.push_back(volume::orbit_request(stored, {1, 1, 1.5}, {.azimuth = azimuth}, 150, 110, 0.7));
  scene.requests.push_back(
      volume::testing::request_for(scene.texture, volume::testing::usual_camera(150, 110), 150, 110, 60));
  for (volume::RenderRequest& request : scene.requests) {
    request.classification = volume::TransferFunction{0, 1, {{0.01F, 0, 0, 0.01F}, {0, 0, 0.02F, 0.02F}}};
    request.termination = 0;
  }
  return scene;
}

TEST(FrameParts, OfRaysAreThoseThatTheRayCasterHasWhereEverySampleShows) {
  const DenseScene scene = dense_scene();
  const volume::VolumeDescription& description = scene.texture.description;
  for (const volume::RenderRequest& request : scene.requests)
    for (const int ranks : {1, 2, 3, 7, 8, 12})
      for (const bool factors : {false, true}) {
        const volume::KdTree tree(description, factors ? volume::by_factors(description, ranks)
                                                       : volume::by_blocks(description, ranks));
        const FrameParts cast = cast_parts(description, scene.texture.texels, request, tree),
                         told = parts_of_rays(description, request, tree);
        EXPECT_EQ(cast.order, told.order);
        EXPECT_GT(told.samples(), 0U);
        for (std::size_t rank = 0; rank < std::size_t(ranks); ++rank) {
          EXPECT_EQ(cast.ranks[rank].samples, told.ranks[rank].samples);
          EXPECT_EQ(cast.ranks[rank].cast, told.ranks[rank].cast);
          EXPECT_EQ(cast.ranks[rank].mask.rect, told.ranks[rank].mask.rect);
          EXPECT_EQ(cast.ranks[rank].mask.touched, told.ranks[rank].mask.touched);
        }
      }
}

FrameParts parts_with_samples(const std::vector<std::uint64_t>& samples) {
  FrameParts parts;
  for (const std::uint64_t of_rank : samples) {
    RankPart& part = parts.ranks.emplace_back();
    part.mask = compositor::PixelMask({0, 0, 10, 10});
    std::ranges::fill(part.mask.touched, std::uint8_t(1));
    part.samples = of_rank;
    parts.order.push_back(int(parts.order.size()));
  }
  return parts;
}

Costs only_samples() {
  Costs costs;
  costs.latency = costs.overhead = costs.gap = costs.per_byte = 0;
  costs.per_byte_packed = costs.per_byte_unpacked = costs.per_pixel_blended = costs.per_pixel_written = 0;
  costs.per_sample = 1;
  return costs;
}

double render_time(const std::vector<std::uint64_t>& samples, int cores) {
  Costs costs = only_samples();
  costs.cores = cores;
  return time_of(parts_with_samples(samples), {}, costs).render;
}

TEST(FrameTime, OfTheSlowestRankWhereEachHasAMachine) {
  EXPECT_DOUBLE_EQ(render_time({4, 9, 2}, 0), 9);
}

TEST(FrameTime, DividesWorkByTheCoresThatRanksShare) {
  EXPECT_DOUBLE_EQ(render_time({8}, 2), 4);            // one thread on each core
  EXPECT_DOUBLE_EQ(render_time({6, 6, 6, 6}, 2), 12);  // all cores busy to the end
  EXPECT_DOUBLE_EQ(render_time({10, 2}, 2), 10);       // two threads, of which one has more work
  // Three share two cores until the first two end after 3, with 2 of the third's 6 done; it goes on alone.
  EXPECT_DOUBLE_EQ(render_time({2, 2, 6}, 2), 3 + 4);
}

double exchange_time(Algorithm algorithm, int ranks, Costs costs) {
  const FrameParts parts = parts_with_samples(std::vector<std::uint64_t>(std::size_t(ranks), 0));
  const CountedExchange exchange =
      counted(parts, algorithm, Gather::root, volume::Operator::over, Layout::rgba32f);
  return time_of(parts, exchange, costs).exchange;
}

TEST(FrameTime, OfMessagesIsThatOfLogGp) {
  const double bytes = compositor::head_bytes + compositor::bytes_per_run + 16 * 100;
  Costs costs = only_samples();
  costs.latency = 1000;
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 1000);  // all at once
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::tree, 8, costs), 3000);    // one round after the other
  costs.overhead = 10;
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 10 + 1000 + 7 * 10);
  costs.overhead = 0;
  costs.per_byte = 1;  // seven messages arrive over one connection
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 1000 + 7 * bytes);
  costs.per_byte = 0;
  costs.gap = 50;
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 1000 + 6 * 50);
  costs.gap = 0;
  costs.latency = 0;
  costs.per_byte_packed = 1;
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), bytes);
  costs.cores = 2;  // seven ranks pack on two cores
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 4 * bytes);
  costs.per_byte_packed = 0;
  costs.per_pixel_blended = 1;
  EXPECT_DOUBLE_EQ(exchange_time(Algorithm::serial, 8, costs), 8 * 100);
}

}  // namespace
}  // namespace understudy::bench
