// SPDX-License-Identifier: Apache-2.0
// Unusual and invalid slices: the image equals the application's bit for bit, or cannot be distinguished from
// it, and there is no error that the application did not cause.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "slice_scenes.h"
#include "spu/chain.h"
#include "tests/all_cases.h"

namespace understudy::spu::testing {
namespace {

using Coordinate = std::array<double, 3>;

struct OddSlices {
  const char* what;
  int slices = 40;
  int pixels = GlApplication::size;  ///< edge of the viewport
  /// Texture coordinate at a vertex of slice `i`.
  std::function<Coordinate(int i, Coordinate place)> coordinate = [](int, Coordinate place) { return place; };
  /// Called after the camera is set.
  std::function<void(const DispatchTable&)> camera = [](const DispatchTable&) {};
  /// Called between the two slices in the middle.
  std::function<void(const DispatchTable&)> half_way = [](const DispatchTable&) {};
};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

std::vector<OddSlices> all_odd_slices() {
  return {
      {.what = "none at all", .slices = 0},
      {.what = "one slice", .slices = 1},
      {.what = "two slices", .slices = 2},
      {.what = "very many slices", .slices = takes_all_cases() ? 100000 : 20000, .pixels = 8},
      {.what = "one coordinate is no number",
       .coordinate =
           [](int i, Coordinate place) {
             if (i == 7) place[1] = nan;
             return place;
           }},
      {.what = "no coordinate is a number",
       .coordinate =
           [](int, Coordinate) {
             return Coordinate{nan, nan, nan};
           }},
      {.what = "infinite coordinates",
       .coordinate =
           [](int, Coordinate place) {
             return Coordinate{place[0] * infinite, place[1], place[2]};
           }},
      {.what = "all coordinates alike",
       .coordinate =
           [](int, Coordinate) {
             return Coordinate{0.4, 0.5, 0.6};
           }},
      {.what = "coordinates that bend",
       .coordinate =
           [](int i, Coordinate place) {
             place[0] += 0.1 * std::sin(0.4 * i);
             return place;
           }},
      {.what = "slices in no order",
       .coordinate =
           [](int i, Coordinate place) {
             place[2] = double(i * 17 % 40) / 40;
             return place;
           }},
      {.what = "a matrix that flattens everything",
       .camera = [](const DispatchTable& gl) { gl.Scaled(1, 1, 0); }},
      {.what = "a matrix that shrinks everything to a point",
       .camera = [](const DispatchTable& gl) { gl.Scaled(0, 0, 0); }},
      {.what = "a matrix of no numbers",
       .camera =
           [](const DispatchTable& gl) {
             std::array<GLdouble, 16> nothing{};
             nothing.fill(nan);
             gl.LoadMatrixd(nothing.data());
           }},
      {.what = "a viewport without pixels", .pixels = 0},
      {.what = "the texture is deleted half way",
       .half_way =
           [](const DispatchTable& gl) {
             GLint bound = 0;
             gl.GetIntegerv(GL_TEXTURE_BINDING_3D, &bound);
             const auto texture = GLuint(bound);
             gl.DeleteTextures(1, &texture);
           }},
      {.what = "the texture gets other texels half way",
       .half_way =
           [](const DispatchTable& gl) {
             const std::vector<std::uint8_t> grey(4 * 24 * 20 * 17, 99);
             gl.TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 24, 20, 17, GL_RGBA, GL_UNSIGNED_BYTE, grey.data());
           }},
      {.what = "the texture loses its texels half way",
       .half_way =
           [](const DispatchTable& gl) {
             gl.TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, 0, 0, 0, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
           }},
  };
}

void draw(GlApplication& app, const OddSlices& odd) {
  const DispatchTable& first = app.gl();
  first.Viewport(0, 0, odd.pixels, odd.pixels);
  first.ClearColor(0.1F, 0.2F, 0.3F, 0);
  first.Clear(GL_COLOR_BUFFER_BIT);
  first.MatrixMode(GL_PROJECTION);
  first.LoadIdentity();
  first.Ortho(-0.2, 1.2, -0.2, 1.2, -2, 2);
  first.MatrixMode(GL_MODELVIEW);
  first.LoadIdentity();
  first.Rotated(10, 0.2, 1, 0);
  odd.camera(first);
  first.Enable(GL_TEXTURE_3D);
  first.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
  first.Enable(GL_BLEND);
  first.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (int i = 0; i < odd.slices; ++i) {
    if (i == odd.slices / 2) odd.half_way(app.gl());
    app.gl().Begin(GL_QUADS);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      const Coordinate place{x, y, (i + 0.5) / odd.slices};
      app.gl().TexCoord3dv(odd.coordinate(i, place).data());
      app.gl().Vertex3dv(place.data());
    }
    app.gl().End();
  }
  app.gl().Disable(GL_TEXTURE_3D);
  app.gl().Disable(GL_BLEND);
  app.end_frame();
}

void set_up(GlApplication& app) {
  const Blob blob;
  std::vector<std::uint8_t> colours;
  for (const std::uint8_t s : blob.texels())
    colours.insert(colours.end(), {s, std::uint8_t(255 - s), 90, std::uint8_t(s / 16)});
  GLuint texture = 0;
  app.gl().GenTextures(1, &texture);
  app.gl().BindTexture(GL_TEXTURE_3D, texture);
  app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    app.gl().TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8, blob.x, blob.y, blob.z, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                      colours.data());
}

/// The image after two frames of a new application.
std::vector<float> shown(const OddSlices& odd, bool under, std::uint64_t& substituted) {
  const auto app = GlApplication::start(Profile::compatibility);
  app->use_chain(under);
  set_up(*app);
  draw(*app, odd);
  draw(*app, odd);
  auto pixels = app->read_pixels();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << odd.what << (under ? ", under Understudy" : ", bare");
  substituted = app->substituted();
  return pixels;
}

TEST(OddSlices, GiveTheApplicationsImageAndNoErrorOfOurs) {
  if (!GlApplication::start(Profile::compatibility))
    GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  for (const OddSlices& odd : all_odd_slices()) {
    std::uint64_t substituted = 0;
    std::uint64_t none = 0;
    const auto under = shown(odd, true, substituted);
    const auto bare = shown(odd, false, none);
    EXPECT_EQ(none, 0U);
    std::printf("%s: %s\n", odd.what, substituted > 0 ? "substituted" : "left");
    if (substituted > 0) {
      EXPECT_GE(psnr(under, bare), 35) << odd.what;
    } else {
      EXPECT_EQ(under, bare) << odd.what;
    }
  }
}

TEST(OddSlices, InAContextThatGoesAwayHarmNobody) {
  for (const SliceScene& scene : all_slice_scenes()) {
    auto app = GlApplication::start(scene.profile);
    if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    scene.set_up(*app);
    scene.draw(*app, 10);
    app->end_frame();
    EXPECT_EQ(app->substituted(), 1U) << scene.name << ": " << app->last_reason();
    scene.draw_to_the_last_slice(*app, 20);
    // The entry library reports that the context is gone: no further calls may be made.
    Chain::current()->abandon();
    app.reset();

    // The process continues and draws in another context.
    app = GlApplication::start(scene.profile);
    scene.set_up(*app);
    scene.draw(*app, 10);
    app->end_frame();
    EXPECT_EQ(app->substituted(), 1U) << scene.name << ": " << app->last_reason();
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << scene.name;
  }
}

}  // namespace
}  // namespace understudy::spu::testing
