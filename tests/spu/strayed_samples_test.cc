// SPDX-License-Identifier: Apache-2.0
// Where application and nodes show different samples along the edges of slices, the rasteriser is the cause: it
// snaps vertices to its grid of 1/256 pixel before it decides which pixel centres a slice covers.
#include <gtest/gtest.h>

#include "colour_target.h"
#include "emulated_scenes.h"
#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

using emulation::Equation;

/// The driver filters floats in float. It interpolates coordinates over the window and divides them by w: about
/// eight roundings of values up to 4.
constexpr emulation::Precision driver_on_floats{
    .coordinate = 32 * emulation::float_step, .window = 1.0 / 256, .value = 8 * emulation::float_step};

class StrayedSamples : public ::testing::TestWithParam<GLenum> {};

TEST_P(StrayedSamples, AreTheRasterisersAndNotOurs) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const GLenum equation = GetParam();
  const SliceScene scene =
      client_arrays_table({[equation](const DispatchTable& gl) { gl.BlendEquation(equation); }});
  scene.set_up(*app);
  const Blob blob;
  std::vector<float> values;
  for (const double value : blob_values()) values.push_back(float(value));
  app->gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R32F, blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT, values.data());
  const ColourTarget target(*app, GL_RGBA32F);
  ASSERT_TRUE(target.complete());
  const float background = equation == GL_MIN ? 1 : 0;
  const auto frame = [&](bool under) {
    app->use_chain(under);
    target.clear({background, background, background, background});
    scene.slices_and_tidy_up(*app, 25);
    app->end_frame();
    return target.read();
  };
  const emulation::BlendFunction function{equation == GL_MIN ? Equation::min : Equation::max};
  const emulation::Frame exact = frame_of(
      {table_cube(blob_values(), 25)}, {background, background, background, background}, {function, function});
  const emulation::Rounding floats = emulation::floating(23);
  const auto bare = frame(false);
  expect_within("the driver", emulation::draw(exact, driver_on_floats, floats, floats), bare);
  const auto under = frame(true);
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  expect_within("Understudy, whose edges are exact", emulation::draw(exact, emulation::ours, floats, floats),
                under);

  emulation::Precision exact_edges = driver_on_floats;
  exact_edges.window = 0;
  const int strayed = channels_outside(emulation::draw(exact, exact_edges, floats, floats), bare);
  std::printf("of the driver's channels, %d of %zu show samples that lie beyond a slice's edge\n", strayed,
              bare.size());
  EXPECT_LT(strayed, int(bare.size() / 1000)) << "too many for a verification that lets every pixel count";
}

INSTANTIATE_TEST_SUITE_P(Of, StrayedSamples, ::testing::Values(GLenum(GL_MAX), GLenum(GL_MIN)),
                         [](const auto& info) { return info.param == GL_MAX ? "Maximum" : "Minimum"; });

}  // namespace
}  // namespace understudy::spu::testing
