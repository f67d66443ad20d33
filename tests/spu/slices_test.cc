// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/slices.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volume/matrix.h"
#include "volume/texture_space.h"

namespace understudy::spu {
namespace {

using volume::Vec3;

/// A parallel camera that looks along -z: texture z increases towards the eye.
const volume::Matrix4 front_view = {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, -1, 0.5, 0, 0, 0, 1};

struct Drawing {
  ObservedPolygons polygons;
  void quad(double x0, double y0, double x1, double y1, double z) {
    for (const auto& [x, y] : {std::pair{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}) {
      polygons.vertices.push_back({{x, y, z}, volume::transform_point(front_view, {x, y, z})});
    }
    polygons.first.push_back(polygons.vertices.size());
  }
  SliceFinding find(std::span<const volume::HalfSpace> cuts = {}) const {
    const auto camera = fit_camera(polygons.vertices);
    if (!camera) return "no camera";
    return find_slices(polygons, *camera, cuts);
  }
};

/// Slices from back to front, as a viewer must draw them for over.
Drawing full_slices(int count) {
  Drawing drawing;
  for (int i = 0; i < count; ++i) drawing.quad(0, 0, 1, 1, (i + 0.5) / count);
  return drawing;
}

std::string reason(const SliceFinding& finding) {
  const auto* refusal = std::get_if<Refusal>(&finding);
  return refusal != nullptr ? refusal->reason : "slices";
}

TEST(Slices, GiveThePlanesFrontFirst) {
  const SliceFinding finding = full_slices(10).find();
  ASSERT_TRUE(std::holds_alternative<SliceSet>(finding)) << reason(finding);
  const SliceSet& set = std::get<SliceSet>(finding);
  EXPECT_EQ(set.planes.count, 10);
  const double sign = set.planes.normal[2];
  EXPECT_NEAR(std::abs(sign), 1, 1e-12);
  EXPECT_NEAR(sign * set.planes.first, 0.95, 1e-12);
  EXPECT_NEAR(sign * set.planes.spacing, -0.1, 1e-12);
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(set.region.low[k], 0.05 + 1e-12);
    EXPECT_GE(set.region.high[k], 0.95 - 1e-12);
  }
}

TEST(Slices, TrianglesOfOneSliceAreOneSlice) {
  Drawing drawing;
  for (int i = 0; i < 8; ++i) {
    const double z = (i + 0.5) / 8;
    const std::array<Vec3, 6> corners{Vec3{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 0, z}, {1, 1, z}, {0, 1, z}};
    for (std::size_t v = 0; v < 6; ++v) {
      drawing.polygons.vertices.push_back({corners[v], volume::transform_point(front_view, corners[v])});
      if (v % 3 == 2) drawing.polygons.first.push_back(drawing.polygons.vertices.size());
    }
  }
  const SliceFinding finding = drawing.find();
  ASSERT_TRUE(std::holds_alternative<SliceSet>(finding)) << reason(finding);
  EXPECT_EQ(std::get<SliceSet>(finding).planes.count, 8);
}

TEST(Slices, APaddedTextureShowsOnlyItsUsedPart) {
  Drawing drawing;
  for (int i = 0; i < 20; ++i) drawing.quad(0, 0, 0.7, 0.85, 0.6 * (i + 0.5) / 20);
  const SliceFinding finding = drawing.find();
  ASSERT_TRUE(std::holds_alternative<SliceSet>(finding)) << reason(finding);
  EXPECT_NEAR(std::get<SliceSet>(finding).region.high[0], 0.7, 1e-12);
  EXPECT_NEAR(std::get<SliceSet>(finding).region.high[1], 0.85, 1e-12);
}

TEST(Slices, AClipPlaneMayCutThem) {
  Drawing drawing;
  for (int i = 0; i < 20; ++i) {
    const double z = (i + 0.5) / 20;
    // x <= z: a diagonal cut.
    drawing.quad(0, 0, z, 1, z);
  }
  const volume::HalfSpace cut{{-1, 0, 1}, 0};
  const SliceFinding with = drawing.find(std::span(&cut, 1));
  EXPECT_TRUE(std::holds_alternative<SliceSet>(with)) << reason(with);
  EXPECT_EQ(reason(drawing.find()), "slices do not fill a box");
}

TEST(Slices, FrontToBackUnderOverIsRefused) {
  Drawing drawing;
  for (int i = 9; i >= 0; --i) drawing.quad(0, 0, 1, 1, (i + 0.5) / 10);
  EXPECT_EQ(reason(drawing.find()), "slices are drawn front to back under a back-to-front blend");
}

TEST(Slices, UnequalSpacingIsRefused) {
  Drawing drawing;
  for (int i = 0; i < 10; ++i) drawing.quad(0, 0, 1, 1, 0.9 * std::pow(i / 9.0, 1.3) + 0.05);
  EXPECT_EQ(reason(drawing.find()), "slices are not equally spaced");
}

TEST(Slices, PlanesInThreeDirectionsAreRefused) {
  Drawing drawing = full_slices(10);
  for (const Vec3& t : {Vec3{0.5, 0, 0}, {0.5, 1, 0}, {0.5, 1, 1}, {0.5, 0, 1}}) {
    drawing.polygons.vertices.push_back({t, volume::transform_point(front_view, t)});
  }
  drawing.polygons.first.push_back(drawing.polygons.vertices.size());
  EXPECT_EQ(reason(drawing.find()), "slices are not parallel");
}

TEST(Slices, CoordinatesOutsideTheTextureAreRefused) {
  Drawing drawing;
  for (int i = 0; i < 10; ++i) drawing.quad(-0.4, -0.4, 1.4, 1.4, (i + 0.5) / 10);
  EXPECT_EQ(reason(drawing.find()), "slices leave the texture");
}

TEST(Slices, AHoleIsRefused) {
  Drawing drawing;
  for (int i = 0; i < 10; ++i) {
    const double z = (i + 0.5) / 10;
    drawing.quad(0, 0, 0.4, 1, z);
    drawing.quad(0.6, 0, 1, 1, z);
  }
  EXPECT_EQ(reason(drawing.find()), "slices do not fill a box");
}

TEST(Slices, NoAreaIsRefused) {
  Drawing drawing = full_slices(10);
  for (ObservedVertex& v : drawing.polygons.vertices) v.texture[0] = v.texture[1];
  const CameraFit camera{front_view, 0};
  EXPECT_EQ(reason(find_slices(drawing.polygons, camera, {})), "slices have no area");
}

TEST(Slices, TenThousandSlicesAreFound) {
  const SliceFinding finding = full_slices(10000).find();
  ASSERT_TRUE(std::holds_alternative<SliceSet>(finding)) << reason(finding);
  EXPECT_EQ(std::get<SliceSet>(finding).planes.count, 10000);
}

}  // namespace
}  // namespace understudy::spu
