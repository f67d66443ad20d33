// SPDX-License-Identifier: Apache-2.0
// One rank or many give the same image.
#include <gmock/gmock.h>

#include <numeric>

#include "tests/volume/parts.h"
#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

Matrix4 random_camera(std::mt19937& random, double aspect) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vec3 eye{2 * uniform(random), 2 * uniform(random), 2 * uniform(random)};
  const Vec3 centre{0.3 * uniform(random), 0.3 * uniform(random), 0.3 * uniform(random)};
  const Matrix4 model{1,
                      0.3 * uniform(random),
                      0.3 * uniform(random),
                      0,
                      0,
                      uniform(random) > 0 ? 1.0 : -1.0,
                      0,
                      0,
                      0.2 * uniform(random),
                      0,
                      1 + 0.5 * uniform(random),
                      0,
                      0,
                      0,
                      0,
                      1};
  const Matrix4 projection =
      uniform(random) > 0 ? perspective(50, aspect, 0.02, 20) : parallel(0.8 * aspect, 0.8, -5, 5);
  return multiply(projection, multiply(look_at(eye, centre, {0.1, 1, 0.2}), multiply(model, unit_cube())));
}

TEST(Partition, GivesTheSameImageForAnyNumberOfRanks) {
  double worst = 0;
  for (int ranks = 2; ranks <= 16; ++ranks)
    for (const TexelType type : {TexelType::u8, TexelType::rgba8, TexelType::f32}) {
      const Texture texture =
          noise(describe({37, 29, 41}, type, ranks % 3 == 0 ? Wrap::repeat : Wrap::border), 31);
      RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 80);
      request.termination = 1e-6F;
      if (ranks % 2 == 0)
        request.fog = Fog{{1, 0.5, 0}, -0.2, {{0, 0, 0, 1}, {0, 0.2F, 0.4F, 0.6F}, {0.5F, 0.5F, 0.5F, 0}}};
      const Whole one = render_whole(texture, request), many = render_parts(texture, request, ranks);
      const double d = difference(one.image, many.image).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, 1e-5) << ranks << " ranks";
      EXPECT_EQ(one.counts.samples, many.counts.samples) << ranks << " ranks";
    }
  std::printf("2 to 16 ranks against 1: largest difference %.2e\n", worst);
}

TEST(Partition, GivesTheSameImageFromAnyCamera) {
  double worst = 0;
  const unsigned seed = 32;
  std::mt19937 random(seed);
  for (int trial = 0; trial < 60; ++trial) {
    const int ranks = 2 + trial % 7;
    const Texture texture = noise(describe({37, 29, 41}, TexelType::u8), unsigned(trial));
    RenderRequest request = request_for(texture, random_camera(random, 45.0 / 39), 45, 39, 80);
    request.op = Operator(trial % 8 < 5 ? 0 : trial % 4);
    if (trial % 5 == 0) request.filter = Filter::nearest;
    const Whole one = render_whole(texture, request), many = render_parts(texture, request, ranks);
    const double d = difference(one.image, many.image).max;
    worst = std::max(worst, d);
    EXPECT_LE(d, request.op == Operator::add ? 2e-5 : 1e-5) << "trial " << trial << ", seed " << seed;
    EXPECT_EQ(one.counts.samples, many.counts.samples) << "trial " << trial;
  }
  std::printf("60 cameras: largest difference %.2e\n", worst);
}

TEST(Partition, HoldsWithTheDefaultTerminationThreshold) {
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8), 33);
  RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 80);
  request.classification = smooth_table(256, 0.9F);
  request.termination = RenderRequest{}.termination;
  const Whole one = render_whole(texture, request);
  for (const int ranks : {2, 3, 4, 7}) {
    const double d = difference(one.image, render_parts(texture, request, ranks).image).max;
    std::printf("%d ranks, threshold %g: %.2e\n", ranks, double(request.termination), d);
    EXPECT_LE(d, 1e-5);
  }
}

TEST(Partition, HoldsWhenRanksOutnumberBlocksAndCells) {
  for (const std::array<int, 3> size : {std::array{5, 3, 4}, {1, 1, 1}, {2, 1, 9}})
    for (const int ranks : {2, 5, 16, 40}) {
      const Texture texture = noise(describe(size, TexelType::u8), 34);
      const RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 80);
      const Whole one = render_whole(texture, request), many = render_parts(texture, request, ranks);
      EXPECT_LE(difference(one.image, many.image).max, 1e-5);
      EXPECT_EQ(one.counts.samples, many.counts.samples);
    }
}

TEST(Partition, HoldsWhenMostOfTheVolumeIsBehindTheEye) {
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8), 34);
  const Matrix4 camera =
      multiply(perspective(60, 45.0 / 39, 0.01, 10),
               multiply(look_at({0.1, -0.05, -0.25}, {-0.1, 0.1, -1}, {0, 1, 0}), unit_cube()));
  for (int ranks = 2; ranks <= 16; ++ranks) {
    const RenderRequest request = request_for(texture, camera, 45, 39, 80);
    EXPECT_LE(difference(render_whole(texture, request).image, render_parts(texture, request, ranks).image).max,
              1e-5)
        << ranks << " ranks";
  }
}

TEST(Partition, HoldsWhenPlanesRunAgainstTheDepth) {
  // Planes go front to back by index even if the depth range is reversed.
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8), 35);
  Matrix4 reversed = usual_camera(45, 39);
  for (int k = 8; k < 12; ++k) reversed[k] = -reversed[k];
  RenderRequest request = request_for(texture, reversed, 45, 39, 80);
  for (const bool swap_planes : {false, true}) {
    if (swap_planes) {
      request.planes.first += request.planes.spacing * (request.planes.count - 1);
      request.planes.spacing = -request.planes.spacing;
    }
    for (const int ranks : {2, 3, 7})
      EXPECT_LE(
          difference(render_whole(texture, request).image, render_parts(texture, request, ranks).image).max,
          1e-5);
  }
}

TEST(KdTree, TilesTheLatticeWithBoxesOnBlockFaces) {
  for (int ranks = 1; ranks <= 40; ++ranks) {
    const VolumeDescription volume =
        describe({130, 75, 99}, TexelType::u8, ranks % 2 ? Wrap::edge : Wrap::repeat);
    const KdTree tree(volume, ranks);
    const CellLattice lattice = cell_lattice(volume);
    double cells = 0, largest = 0;
    for (int rank = 0; rank < ranks; ++rank) {
      const TexelBox& box = tree.box(rank);
      double own = 1;
      for (int k = 0; k < 3; ++k) {
        own *= box.high[k] - box.low[k];
        EXPECT_GE(box.low[k], lattice.origin[k]);
        EXPECT_EQ((box.low[k] - lattice.origin[k]) % 8, 0) << "rank " << rank << " of " << ranks;
      }
      cells += own;
      largest = std::max(largest, own);
      for (int other = 0; other < rank; ++other) {
        bool apart = false;
        for (int k = 0; k < 3; ++k)
          apart = apart || tree.box(other).high[k] <= box.low[k] || box.high[k] <= tree.box(other).low[k];
        EXPECT_TRUE(apart) << rank << " overlaps " << other;
      }
    }
    EXPECT_EQ(cells, double(lattice.cells[0]) * lattice.cells[1] * lattice.cells[2]);
    EXPECT_LT(largest, 2.2 * cells / ranks) << ranks << " ranks";
  }
  EXPECT_THROW(KdTree(describe({4, 4, 4}, TexelType::u8), 0), std::invalid_argument);
  EXPECT_THROW(KdTree(describe({4, 4, 4}, TexelType::u8), max_ranks + 1), std::invalid_argument);
}

/// Along any ray, boxes that are entered earlier must come earlier: checked at points of the ray, from near to
/// far.
TEST(KdTree, OrderFollowsEveryRay) {
  std::mt19937 random(36);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const VolumeDescription volume = describe({64, 48, 80}, TexelType::u8);
  for (int trial = 0; trial < 200; ++trial) {
    const KdTree tree(volume, 1 + trial % 19);
    const Matrix4 m = random_camera(random, 1);
    const auto order = tree.visibility_order(m);
    ASSERT_THAT(order, ::testing::SizeIs(tree.ranks()));
    std::vector<int> place(order.size(), -1);
    for (std::size_t i = 0; i < order.size(); ++i) place[std::size_t(order[i])] = int(i);
    ASSERT_THAT(place, ::testing::Not(::testing::Contains(-1)));
    const Matrix4 back = *inverse(m);
    for (int ray = 0; ray < 50; ++ray) {
      const double X = uniform(random), Y = uniform(random);
      int reached = -1;
      for (int i = 0; i <= 400; ++i) {
        const Vec4 h = transform(back, {X, Y, -1 + i / 200.0, 1});
        std::array<int, 3> cell;
        bool inside = h[3] > 0;
        for (int k = 0; k < 3; ++k) {
          cell[k] = int(std::floor(h[k] / h[3] * volume.size[k] - 0.5));
          inside = inside && cell[k] >= 0 && cell[k] < volume.size[k] - 1;
        }
        for (int rank = 0; inside && rank < tree.ranks(); ++rank) {
          const TexelBox& box = tree.box(rank);
          bool holds = true;
          for (int k = 0; k < 3; ++k) holds = holds && cell[k] >= box.low[k] && cell[k] < box.high[k];
          if (!holds) continue;
          ASSERT_GE(place[std::size_t(rank)], reached) << "trial " << trial << ", seed 36";
          reached = place[std::size_t(rank)];
        }
      }
    }
  }
}

TEST(KdTree, OrderStandsTheNoiseOfAFittedParallelCamera) {
  // A fit leaves about 1e-9, of either sign, in the last row of a parallel projection.
  const VolumeDescription volume = describe({64, 48, 80}, TexelType::u8);
  const KdTree tree(volume, 8);
  const Matrix4 clean =
      multiply(parallel(1, 1, 0.1, 10), multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
  for (const double noise : {1e-9, -1e-9}) {
    Matrix4 noisy = clean;
    for (int k = 12; k < 15; ++k) noisy[k] = noise;
    EXPECT_EQ(tree.visibility_order(noisy), tree.visibility_order(clean));
  }
  EXPECT_THROW(tree.visibility_order(Matrix4{}), std::invalid_argument);
}

TEST(Footprint, HoldsEveryPixelThatTheBoxTouches) {
  std::mt19937 random(37);
  double touched = 0, offered = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Texture texture = sampled(describe({37, 29, 41}, TexelType::u8), constant_field(1));
    RenderRequest request = request_for(texture, random_camera(random, 45.0 / 39), 45, 39, 60);
    if (trial % 4 == 0) request.region = {{0.2, 0.3, 0.1}, {0.8, 0.7, 1}};
    const KdTree tree(texture.description, 1 + trial % 9);
    for (int rank = 0; rank < tree.ranks(); ++rank) {
      const BrickStore store = filled(texture, tree.box(rank));
      const Rect bound = footprint(request, texture.description, tree.box(rank));
      EXPECT_EQ(intersection(bound, request.window), bound.empty() ? Rect{} : bound);
      Image image(request.window);
      FrameCounts counts;
      raycast(store, request, image, counts);
      Rect seen;
      for (int y = request.window.y; y < request.window.y + request.window.height; ++y)
        for (int x = request.window.x; x < request.window.x + request.window.width; ++x)
          if (image.at(x, y)[3] > 0) seen = bounding(seen, {x, y, 1, 1});
      EXPECT_EQ(bounding(bound, seen), bound) << "trial " << trial << ", rank " << rank;
      touched += double(seen.pixels());
      offered += double(bound.pixels());
    }
  }
  std::printf("footprints hold %.2f times the pixels of the smallest rectangles\n", offered / touched);
  EXPECT_LT(offered, 1.5 * touched);
}

TEST(Footprint, IsTightAroundABoxInFrontAndEmptyBehind) {
  const VolumeDescription volume = describe({8, 8, 8}, TexelType::u8);
  RenderRequest request;
  request.viewport = request.window = {0, 0, 100, 100};
  request.texture_to_clip = {1, 0, 0, -0.5, 0, 1, 0, -0.5, 0, 0, 1, 0, 0, 0, 0, 1};
  const Rect rect = footprint(request, Box{});
  EXPECT_GE(rect.width, 50);
  EXPECT_LE(rect.width, 52);
  request.texture_to_clip[11] = 5;
  EXPECT_TRUE(footprint(request, Box{}).empty());
  EXPECT_TRUE(footprint(request, volume, {{3, 3, 3}, {3, 5, 5}}).empty());
}

}  // namespace
}  // namespace understudy::volume::testing
