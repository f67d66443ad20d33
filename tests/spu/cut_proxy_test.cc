// SPDX-License-Identifier: Apache-2.0
// Ray casters whose volume is cut: by cropping, by clipping planes, or by the near plane around an eye inside
// the volume. Also ray casters that sum up their samples.
#include <gtest/gtest.h>

#include <cmath>

#include "ray_caster_scene.h"
#include "spu/volume/proxy/cut_box.h"
#include "spu/volume/proxy/cuts.h"
#include "volume/matrix.h"
#include "volume/texture_space.h"

namespace understudy::spu::testing {
namespace {

using CutComposition = MarchStyle::Composition;

constexpr double alike = 45;         // dB
constexpr double another = 35;       // dB; below it, the image is a different one
constexpr double another_grey = 46;  // dB; for means, which are dark
constexpr std::uint32_t middle_region = 1U << 13U;

struct CutScene : RayCasterScene {
  using RayCasterScene::RayCasterScene;
  std::vector<float> expect_alike(double angle, const std::string& what, double least = alike) {
    return RayCasterScene::expect_alike(angle, what, least);
  }
};

constexpr std::array<float, 3> stretched{1.0F, 1.3F, 0.7F};
constexpr std::array<float, 6> grid{0.25F, 0.7F, 0.4F, 1.0F, 0.2F, 0.45F};

std::uint32_t regions(bool (*kept)(int, int, int)) {
  std::uint32_t mask = 0;
  for (int i = 0; i < 27; ++i) {
    if (kept(i % 3, i / 3 % 3, i / 9)) mask |= 1U << unsigned(i);
  }
  return mask;
}

int outside(int x, int y, int z) {
  return (x != 1 ? 1 : 0) + (y != 1 ? 1 : 0) + (z != 1 ? 1 : 0);
}

TEST(CutProxies, CroppedRegionsAreLeftOut) {
  struct Shape {
    const char* name;
    std::uint32_t kept;
  };
  const std::array shapes{
      Shape{"sub-volume", middle_region},
      Shape{"half", regions([](int x, int, int) { return x < 2; })},
      Shape{"cross", regions([](int x, int y, int z) { return outside(x, y, z) <= 1; })},
      Shape{"fence", regions([](int x, int y, int z) { return outside(x, y, z) <= 2; })},
      Shape{"inverted cross", regions([](int x, int y, int z) { return outside(x, y, z) > 1; })},
      Shape{"all but the sub-volume", MarchStyle::all_regions & ~middle_region}};
  CutScene scene(MarchStyle{.extent = stretched});
  if (!scene.app) GTEST_SKIP() << "no EGL context of this profile here; install libegl1 and libgl1-mesa-dri";
  const auto whole = scene.expect_alike(25, "whole");
  scene.caster.style.cropping_planes = grid;
  for (const Shape& shape : shapes) {
    scene.caster.style.kept_regions = shape.kept;
    const auto cropped = scene.expect_alike(25, shape.name);
    EXPECT_LT(psnr(cropped, whole), alike) << shape.name << " leaves out nothing: the test tests nothing";
    scene.expect_alike(-140, shape.name);
  }
}

TEST(CutProxies, CroppingIsThereFromTheFirstFrameOnUnderEveryComposition) {
  for (const auto composition : {CutComposition::over, CutComposition::maximum}) {
    MarchStyle style{.composition = composition};
    style.cropping_planes = {0.2F, 0.8F, 0.3F, 0.9F, 0.1F, 0.7F};
    style.kept_regions = middle_region;
    if (composition == CutComposition::maximum) style.extent = {1.2F, 1.0F, 0.85F};
    CutScene scene(style);
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    scene.expect_alike(25, composition == CutComposition::over ? "over" : "maximum");
  }
}

TEST(CutProxies, RaysBeginAndEndAtClippingPlanes) {
  const std::array<float, 6> facing{1.5F, 2.7F, 3.4F, -0.4F, -0.2F, -1};
  const std::array<float, 6> averted{1.5F, 2.5F, 3.2F, 0.5F, 0.3F, 1};
  for (const float past : {0.0F, 1.0F}) {
    for (const bool parallel : {false, true}) {
      MarchStyle style{.parallel = parallel, .extent = stretched, .step = 0.05F};
      style.past_planes = past;
      style.clipping_planes = {facing, averted};
      CutScene scene(style);
      if (!scene.app) GTEST_SKIP() << "no EGL context here";
      const auto cut = scene.expect_alike(20, "two planes");
      scene.expect_alike(-150, "two planes from behind");
      scene.caster.style.clipping_planes[0][2] -= 0.15F;
      scene.expect_alike(20, "a plane that has moved");
      scene.caster.style.clipping_planes.clear();
      const auto whole = scene.expect_alike(20, "no planes");
      EXPECT_LT(psnr(cut, whole), another) << "the plane cuts nothing: the test tests nothing";
    }
  }
}

TEST(CutProxies, UniformsStayAsTheyWere) {
  MarchStyle style{.extent = stretched};
  style.cropping_planes = grid;
  style.kept_regions = middle_region;
  style.clipping_planes = {{1.5F, 2.7F, 3.4F, -0.4F, -0.2F, -1}};
  CutScene scene(style);
  if (!scene.app) GTEST_SKIP() << "no EGL context here";
  scene.expect_alike(20, "cropped and clipped");
  const DispatchTable& gl = scene.app->driver();
  const GLuint program = scene.caster.program();
  for (int region = 0; region < 27; ++region) {
    GLint flag = -1;
    const std::string name = "in_croppingFlags[" + std::to_string(region + 1) + "]";
    gl.GetUniformiv(program, gl.GetUniformLocation(program, name.c_str()), &flag);
    EXPECT_EQ(flag, region == 13 ? 1 : 0) << name;
  }
  GLfloat numbers = 0;
  gl.GetUniformfv(program, gl.GetUniformLocation(program, "in_clippingPlanes[0]"), &numbers);
  EXPECT_EQ(numbers, 6);
}

TEST(CutProxies, SumsAreThoseOfTheApplication) {
  for (const bool parallel : {false, true}) {
    CutScene scene(
        MarchStyle{.composition = CutComposition::grey_sum, .parallel = parallel, .extent = stretched});
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    const auto thin = scene.expect_alike(25, "sum");
    scene.expect_alike(-60, "sum");
    scene.app->use_chain(true);
    scene.caster.set_table(*scene.app, 0.4F);
    EXPECT_LT(psnr(scene.expect_alike(25, "sum that saturates"), thin), another) << "the table changes nothing";
  }
}

TEST(CutProxies, MeansAreThoseOfTheApplication) {
  const std::array<float, 6> planes{0.2F, 0.7F, 0, 1, 0.3F, 1};
  for (const CutComposition composition : {CutComposition::mean_of_colours, CutComposition::mean_of_values}) {
    for (const bool divided : {false, true}) {
      CutScene scene(MarchStyle{.composition = composition, .divided = divided, .extent = stretched});
      if (!scene.app) GTEST_SKIP() << "no EGL context here";
      const std::string what =
          composition == CutComposition::mean_of_colours ? "mean of colours" : "mean of values";
      const auto thin = scene.expect_alike(25, what);
      scene.expect_alike(-60, what);
      scene.app->use_chain(true);
      scene.caster.set_table(*scene.app, 0.4F);
      EXPECT_LT(psnr(scene.expect_alike(25, what + ", another table"), thin), another_grey);
      if (divided) continue;
      scene.caster.style.cropping_planes = planes;
      scene.caster.style.kept_regions = 1U << 13U;
      // Where the ray barely touches a plane, one sample more or less changes the mean of a few samples
      // considerably.
      scene.expect_alike(25, what + ", cropped", 40);
    }
  }
}

TEST(CutProxies, TheEyeGoesInsideAndOutAgain) {
  for (const auto& extent : {std::array<float, 3>{1, 1, 1}, stretched}) {
    CutScene scene(MarchStyle{.extent = extent});
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    scene.expect_alike(25, "outside");
    scene.caster.style.closed_before_eye = true;
    scene.caster.style.near = 0.02;
    for (const double distance : {0.6, 0.3, 0.0}) {
      scene.caster.style.distance = distance;
      for (const double angle : {25.0, 70.0, 200.0}) {
        // While the eye is inside, images that fail verification may be drawn by the application instead.
        const auto before = scene.app->substituted();
        const auto under = scene.frame(true, angle);
        const double likeness = psnr(under, scene.frame(false, angle));
        const bool substituted = scene.app->substituted() > before;
        std::printf("eye %.1f from the middle, %g degrees: %.1f dB%s\n", distance, angle, likeness,
                    substituted ? "" : (", left: " + scene.app->last_reason()).c_str());
        EXPECT_GE(likeness, alike);
      }
    }
    scene.caster.style.closed_before_eye = false;
    scene.caster.style.distance = MarchStyle{}.distance;
    scene.caster.style.near = MarchStyle{}.near;
    scene.expect_alike(40, "outside again");
  }
}

TEST(CutProxies, TheEyeIsInsideFromTheFirstFrameOn) {
  for (const auto& extent : {std::array<float, 3>{1, 1, 1}, stretched}) {
    MarchStyle style{.extent = extent};
    style.closed_before_eye = true;
    style.near = 0.02;
    style.distance = 0.2;
    CutScene scene(style);
    if (!scene.app) GTEST_SKIP() << "no EGL context here";
    scene.expect_alike(30, "inside at first");
    scene.expect_alike(200, "inside, turned");
    scene.caster.style.closed_before_eye = false;
    scene.caster.style.distance = MarchStyle{}.distance;
    scene.caster.style.near = MarchStyle{}.near;
    scene.expect_alike(40, "outside");
  }
}

/// Index of the part that contains the point, or -1.
int part_at(const std::vector<std::vector<volume::HalfSpace>>& parts, const volume::Vec3& p) {
  int found = -1;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    bool in = true;
    for (const auto& plane : parts[i]) in = in && volume::dot(plane.normal, p) + plane.offset >= 0;
    if (!in) continue;
    EXPECT_EQ(found, -1) << "two parts overlap";
    found = int(i);
  }
  return found;
}

TEST(CroppedParts, HoldWhatIsKeptNearestFirst) {
  const std::array<double, 6> planes{0.3, 0.6, 0.2, 0.7, 0.4, 0.8};
  for (const std::uint32_t mask : {0x2000U, 0x7ffdfffU, 0x5a5a5a5U, 0x1084210U, 0U, MarchStyle::all_regions}) {
    for (const std::array<double, 4>& eye :
         {std::array<double, 4>{3, 2, -1, 1}, {0.4, 0.5, 0.5, 1}, {1, -0.5, 0.2, 0}}) {
      std::array<bool, 27> kept{};
      for (unsigned i = 0; i < 27; ++i) kept[i] = (mask >> i & 1U) != 0;
      const auto parts = kept_parts(kept, planes, eye);
      for (int n = 0; n < 1000; ++n) {
        const std::array<int, 3> place{n % 10, n / 10 % 10, n / 100};
        const volume::Vec3 p{(place[0] + 0.5) / 10, (place[1] + 0.5) / 10, (place[2] + 0.5) / 10};
        std::size_t region = 0;
        for (std::size_t k = 0, stride = 1; k < 3; ++k, stride *= 3)
          region += stride * std::size_t((p[k] >= planes[2 * k]) + (p[k] >= planes[2 * k + 1]));
        const int part = part_at(parts, p);
        EXPECT_EQ(part >= 0, kept[region]);
        if (part < 0) continue;
        // No later part may lie between the point and the eye.
        for (int step = 0; step < 20; ++step) {
          const double s = step / 20.0;
          volume::Vec3 q{};
          for (std::size_t k = 0; k < 3; ++k)
            q[k] = eye[3] == 0 ? p[k] + 2 * s * eye[k] : p[k] + s * (eye[k] - p[k]);
          bool on_plane = false;
          for (std::size_t k = 0; k < 6; ++k) on_plane = on_plane || std::abs(q[k / 2] - planes[k]) < 1e-9;
          const bool in_box = !on_plane && q[0] > 0 && q[0] < 1 && q[1] > 0 && q[1] < 1 && q[2] > 0 && q[2] < 1;
          if (in_box) {
            EXPECT_LE(part_at(parts, q), part);
          }
        }
      }
    }
  }
}

ObservedPolygons cut_cube(bool closed) {
  // x + y + z >= 1/2 of the unit cube: three faces lose a corner, and a triangle closes the cut.
  const std::vector<std::vector<volume::Vec3>> faces{
      {{0.5, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0.5, 0}},
      {{0, 0.5, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {0, 0, 0.5}},
      {{0, 0, 0.5}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0.5, 0, 0}},
      {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}},
      {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}},
      {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
      {{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};
  ObservedPolygons polygons;
  for (std::size_t f = 0; f < faces.size() - (closed ? 0 : 1); ++f) {
    for (const volume::Vec3& p : faces[f]) {
      ObservedVertex v;
      v.texture = {2 * p[0] - 1, p[1], 3 * p[2]};
      polygons.vertices.push_back(v);
    }
    polygons.first.push_back(polygons.vertices.size());
  }
  return polygons;
}

TEST(CutBox, IsAClosedSurface) {
  const auto found = cut_box_of(cut_cube(true));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->box.low[0], -1, 1e-12);
  EXPECT_NEAR(found->box.high[2], 3, 1e-12);
  const auto above = [&](double x, double y, double z) {
    return volume::dot(found->cut.normal, {2 * x - 1, y, 3 * z}) + found->cut.offset;
  };
  EXPECT_NEAR(above(0.5, 0, 0), 0, 1e-9);
  EXPECT_NEAR(above(0.1, 0.1, 0.3), 0, 1e-9);
  EXPECT_GT(above(1, 1, 1), 0);
  EXPECT_FALSE(cut_box_of(cut_cube(false))) << "the corner is open";
  auto dented = cut_cube(true);
  dented.vertices[5].texture = {0, 0.5, 1.5};
  EXPECT_FALSE(cut_box_of(dented));
}

}  // namespace
}  // namespace understudy::spu::testing
