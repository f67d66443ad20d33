// SPDX-License-Identifier: Apache-2.0
// Which textures are pieces of one volume, and their positions in it.
#include "spu/volume/merging/tiling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volume/matrix.h"
#include "volume/sampling.h"
#include "volume/texture_filter.h"

namespace understudy::spu {
namespace {

using volume::Filter;
using volume::Matrix4;

constexpr std::array<volume::Wrap, 3> edges{volume::Wrap::edge, volume::Wrap::edge, volume::Wrap::edge};

/// From texels of the whole volume to clip space: rotated, in perspective.
Matrix4 camera() {
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  const Matrix4 turned{c * 0.02,  0.003, s * 0.02, -0.9, 0, 0.025, 0, -0.6,
                       -s * 0.02, 0.001, c * 0.02, -3,   0, 0,     0, 1};
  const Matrix4 projection{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1.2, -2.2, 0, 0, -1, 0};
  return volume::multiply(projection, turned);
}

/// A texture that holds `size` texels from `origin` on, of which the box from `low` to `high` (in texels of the
/// whole volume) is drawn.
DrawnBrick brick(const std::array<int, 3>& origin, const std::array<int, 3>& size, const volume::Vec3& low,
                 const volume::Vec3& high, Filter filter = Filter::linear, const Matrix4& whole = camera()) {
  Matrix4 placed{};
  placed[15] = 1;
  DrawnBrick drawn;
  drawn.size = size;
  for (std::size_t k = 0; k < 3; ++k) {
    placed[5 * k] = size[k];
    placed[4 * k + 3] = origin[k];
    drawn.region.low[k] = (low[k] - origin[k]) / size[k];
    drawn.region.high[k] = (high[k] - origin[k]) / size[k];
  }
  drawn.texture_to_clip = volume::multiply(whole, placed);
  drawn.shown = texels_read(drawn.region, size, filter);
  return drawn;
}

/// A row of bricks along x: a volume of 37 x 21 x 9 texels in textures of 16 that share 1 + 2 `ghost` texels;
/// the last texture is smaller, or padded to 16.
std::vector<DrawnBrick> row(int ghost, bool padded) {
  std::vector<DrawnBrick> bricks;
  constexpr int size = 37;
  const int step = 16 - 1 - 2 * ghost;
  for (int first = 0;; first += step) {
    const bool last = first + 16 >= size;
    const int texels = last ? size - first : 16;
    bricks.push_back(brick({first, 0, 0}, {padded ? 16 : texels, 21, 9},
                           {first == 0 ? 0 : first + ghost + 0.5, 0, 0},
                           {last ? size : first + texels - ghost - 0.5, 21, 9}));
    if (last) return bricks;
  }
}

class Rows : public ::testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(Rows, AreOneVolume) {
  const auto [ghost, padded] = GetParam();
  const auto bricks = row(ghost, padded);
  const auto found = find_tiling(bricks, Filter::linear, edges);
  ASSERT_TRUE(std::holds_alternative<Tiling>(found)) << std::get<std::string>(found);
  const auto& tiling = std::get<Tiling>(found);
  // With padding, one texel beyond the volume is read.
  EXPECT_EQ(tiling.size, (std::array<int, 3>{padded ? 38 : 37, 21, 9}));
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    EXPECT_EQ(tiling.places[i].origin, (std::array<int, 3>{int(i) * (15 - 2 * ghost), 0, 0}));
    const PlaceMap map = map_of(tiling, i, bricks[i].size);
    EXPECT_NEAR(map({0, 0, 0})[0] * tiling.size[0], tiling.places[i].origin[0], 1e-9);
    EXPECT_NEAR(map({1, 1, 1})[0] * tiling.size[0], tiling.places[i].origin[0] + bricks[i].size[0], 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Rows, ::testing::Combine(::testing::Values(0, 1, 2), ::testing::Bool()));

std::string reason(const std::vector<DrawnBrick>& bricks, Filter filter = Filter::linear,
                   const std::array<volume::Wrap, 3>& wrap = edges) {
  const auto found = find_tiling(bricks, filter, wrap);
  return std::holds_alternative<Tiling>(found) ? "" : std::get<std::string>(found);
}

TEST(Tilings, LackNoTexelsAtTheirFaces) {
  const std::vector<DrawnBrick> apart{brick({0, 0, 0}, {8, 8, 8}, {0, 0, 0}, {8, 8, 8}),
                                      brick({8, 0, 0}, {8, 8, 8}, {8, 0, 0}, {16, 8, 8})};
  EXPECT_EQ(reason(apart), "a brick's faces show: it does not hold its neighbour's texels");
  const std::vector<DrawnBrick> blocky{brick({0, 0, 0}, {8, 8, 8}, {0, 0, 0}, {8, 8, 8}, Filter::nearest),
                                       brick({8, 0, 0}, {8, 8, 8}, {8, 0, 0}, {16, 8, 8}, Filter::nearest)};
  EXPECT_EQ(reason(blocky, Filter::nearest), "") << "the nearest texel is the brick's own";
}

TEST(Tilings, DoNotRepeat) {
  EXPECT_EQ(reason(row(0, false), Filter::linear, {volume::Wrap::repeat, edges[1], edges[2]}),
            "a brick's texture repeats");
}

TEST(Tilings, MayLackABrickInALine) {
  auto bricks = row(1, false);
  bricks.erase(bricks.begin() + 1);
  EXPECT_EQ(reason(bricks), "") << "whether the slices fill the box is asked of the slices";
  bricks = {bricks.front(), bricks.back()};
  bricks.back() = brick({200, 0, 0}, {16, 21, 9}, {200, 0, 0}, {216, 21, 9});
  EXPECT_EQ(reason(bricks), "the textures do not fill a box");
}

TEST(Tilings, AreOfOneLattice) {
  const auto other = [](const Matrix4& whole) {
    return std::vector{brick({0, 0, 0}, {8, 8, 8}, {0, 0, 0}, {7.5, 8, 8}),
                       brick({7, 0, 0}, {8, 8, 8}, {7.5, 0, 0}, {15, 8, 8}, Filter::linear, whole)};
  };
  EXPECT_EQ(reason(other(camera())), "");
  Matrix4 turn = volume::identity();
  turn[0] = turn[5] = std::cos(0.1);
  turn[4] = std::sin(0.1);
  turn[1] = -turn[4];
  Matrix4 shift = volume::identity();
  shift[3] = 0.5;
  Matrix4 stretch = volume::identity();
  stretch[10] = 1.1;
  for (const Matrix4& moved : {turn, shift, stretch})
    EXPECT_EQ(reason(other(volume::multiply(camera(), moved))), "the textures' texels are not of one lattice");
  Matrix4 away = volume::identity();
  away[3] = -4;
  EXPECT_EQ(reason(other(volume::multiply(camera(), away))), "the textures overlap");
}

TEST(Tilings, AreDrawnFromBackToFront) {
  // The eye is far up the z axis; planes are numbered away from it.
  const Matrix4 from_above{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
  const volume::SlicePlanes planes{{0, 0, 1}, 1, -0.1, 10};
  const std::vector<volume::Box> rising{{{0, 0, 0}, {1, 1, 0.5}}, {{0, 0, 0.5}, {1, 1, 1}}};
  const std::vector<volume::Box> falling{rising[1], rising[0]};
  EXPECT_TRUE(drawn_in_order(rising, from_above, planes, true));
  EXPECT_FALSE(drawn_in_order(falling, from_above, planes, true));
  EXPECT_FALSE(drawn_in_order(rising, from_above, planes, false));
  EXPECT_TRUE(drawn_in_order(falling, from_above, planes, false));
  // Bricks side by side do not hide each other.
  const std::vector<volume::Box> beside{{{0, 0, 0}, {0.5, 1, 1}}, {{0.5, 0, 0}, {1, 1, 1}}};
  EXPECT_TRUE(drawn_in_order(beside, from_above, planes, true));
  EXPECT_TRUE(drawn_in_order(beside, from_above, planes, false));
}

}  // namespace
}  // namespace understudy::spu
