// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/slices.h"

#include <gtest/gtest.h>

#include <random>

namespace viewer {
namespace {

constexpr unsigned seed = 20240;

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalised({normal(random), normal(random), normal(random)});
}

Vec3 to_double(const Vec3f& v) {
  return {v[0], v[1], v[2]};
}

double polygon_area(const SliceStack& stack, const Slice& slice) {
  double area = 0;
  const Vec3 first = to_double(stack.vertices[slice.first].position);
  for (std::uint32_t i = 1; i + 1 < slice.count; ++i)
    area += 0.5 * length(cross(to_double(stack.vertices[slice.first + i].position) - first,
                               to_double(stack.vertices[slice.first + i + 1].position) - first));
  return area;
}

TEST(Slices, BoxHasADiagonalOfOneAndKnowsItsFinestVoxel) {
  const Box box = box_of({10, 20, 30}, {3, 2, 0.5});
  EXPECT_NEAR(length(box.edges), 1, 1e-12);
  EXPECT_NEAR(box.edges[0] / box.edges[2], 30.0 / 15.0, 1e-12);
  EXPECT_NEAR(box.finest_voxel_edge, box.edges[2] / 30, 1e-12);
}

TEST(Slices, OnePerFinestVoxelEdgeUnlessANumberIsAsked) {
  const Box cube = box_of({32, 32, 32}, {1, 1, 1});
  EXPECT_EQ(slices_across_diagonal(cube, 0), 56);  // ceil(32 sqrt 3)
  EXPECT_EQ(slices_across_diagonal(cube, 7), 7);
}

TEST(Slices, AlongAnAxisTheyAreFullRectanglesBackToFront) {
  const Box box = box_of({4, 3, 2}, {1, 1, 1});
  const SliceStack stack = cut_slices(box, {0, 0, -1}, 100);
  EXPECT_NEAR(static_cast<double>(stack.slices.size()), box.edges[2] * 100, 1.0);
  for (std::size_t i = 0; i < stack.slices.size(); ++i) {
    EXPECT_EQ(stack.slices[i].count, 4U);
    EXPECT_NEAR(polygon_area(stack, stack.slices[i]), box.edges[0] * box.edges[1], 1e-6);
    if (i > 0) {
      EXPECT_NEAR(stack.slices[i - 1].offset - stack.slices[i].offset, stack.spacing, 1e-12);
    }
  }
}

TEST(Slices, VerticesLieOnTheirPlaneInTheBoxAndTextureCoordinatesSpanIt) {
  std::mt19937 random(seed);
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const Box box = box_of({256, 256, 110}, {1, 1, 1.7});
  double lowest = 1, highest = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const SliceStack stack = cut_slices(box, random_direction(random), 200);
    ASSERT_FALSE(stack.slices.empty());
    for (const Slice& slice : stack.slices) {
      EXPECT_GE(slice.count, 3U);
      EXPECT_LE(slice.count, 6U);
      for (std::uint32_t i = slice.first; i < slice.first + slice.count; ++i) {
        const Vec3 position = to_double(stack.vertices[i].position),
                   texture = to_double(stack.vertices[i].texture);
        EXPECT_NEAR(dot(stack.normal, position), slice.offset, 1e-6);
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_NEAR(texture[axis], position[axis] / box.edges[axis] + 0.5, 1e-6);
          lowest = std::min(lowest, texture[axis]);
          highest = std::max(highest, texture[axis]);
        }
      }
    }
  }
  EXPECT_GE(lowest, -1e-6);
  EXPECT_LE(highest, 1 + 1e-6);
  EXPECT_NEAR(lowest, 0, 1e-6);
  EXPECT_NEAR(highest, 1, 1e-6);
}

TEST(Slices, TogetherFillTheBoxFromAnyDirection) {
  std::mt19937 random(seed);
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const Box box = box_of({3, 5, 7}, {1, 1, 1});
  const double volume = box.edges[0] * box.edges[1] * box.edges[2];
  double worst = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const SliceStack stack = cut_slices(box, random_direction(random), 1000);
    double sum = 0;
    for (const Slice& slice : stack.slices) sum += polygon_area(stack, slice) * stack.spacing;
    worst = std::max(worst, std::abs(sum / volume - 1));
  }
  std::printf("area times spacing against the box's volume: %.2e\n", worst);
  // A wrong vertex order or a missed corner would lose whole triangles.
  EXPECT_LT(worst, 1e-3);
}

TEST(Slices, ASingleSliceGoesThroughTheCentre) {
  const SliceStack stack = cut_slices(box_of({8, 8, 8}, {1, 1, 1}), normalised({1, 2, 3}), 1);
  ASSERT_EQ(stack.slices.size(), 1U);
  EXPECT_EQ(stack.slices[0].offset, 0);
}

}  // namespace
}  // namespace viewer
