// SPDX-License-Identifier: Apache-2.0
// Adaptive steps are closer to the integral than as many samples, for any partition and instruction set alike.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// Each step is `voxels` long in a volume of 40 texels; opacity is corrected so that the medium stays the same.
struct Setting {
  Method method = Method::adaptive;
  double voxels = 1;
  float tolerance = 1e-3F;
};

/// Opacity of one voxel, with enough entries that its extinction is linear between them.
TransferFunction table_of(const std::function<double(double)>& opacity, double voxels) {
  TransferFunction table;
  for (int i = 0; i <= 2048; ++i) {
    const double v = i / 2048.0, a = -std::expm1(voxels * std::log1p(-opacity(v)));
    table.entries.push_back({float(a * (0.2 + 0.8 * v)), float(a * (1 - v)), float(0.5 * a), float(a)});
  }
  return table;
}

double spikes(double v) {
  double sum = 0;
  for (const double at : {0.15, 0.45, 0.75}) sum += 0.6 * std::max(0.0, 1 - std::abs(v - at) / 0.02);
  return sum;
}
double layer(double v) {
  return std::clamp((v - 0.45) / 0.01, 0.0, 0.95);
}
double smooth(double v) {
  return 0.05 + 0.04 * std::sin(5 * v);
}

RenderRequest request_of(Texture& texture, const std::function<double(double)>& opacity,
                         const Setting& setting) {
  RenderRequest request = request_on_steps(texture);
  const double steps = 40 / setting.voxels;
  request.steps->metric = {steps, 0, 0, 0, steps, 0, 0, 0, steps};
  request.steps->first = 0.5;
  request.classification = table_of(opacity, setting.voxels);
  request.method = setting.method;
  request.tolerance = setting.tolerance;
  request.window = {10, 12, 22, 17};
  give_ghost_layer(texture, request);
  return request;
}

ReferenceImage integral(const Texture& texture, const RenderRequest& request) {
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const Medium medium = Medium::of_samples(std::get<TransferFunction>(request.classification), 1);
  ReferenceImage exact{request.window, {}};
  for (int y = request.window.y; y < request.window.y + request.window.height; ++y)
    for (int x = request.window.x; x < request.window.x + request.window.width; ++x)
      for (const double v : pixel_integral(field, texture.description.size, request, medium, x, y))
        exact.rgba.push_back(v);
  return exact;
}

struct Result {
  double rms = 0;
  std::uint64_t samples = 0;
};

Result result_of(Texture& texture, const std::function<double(double)>& opacity, const Setting& setting,
                 const ReferenceImage& exact) {
  const RenderRequest request = request_of(texture, opacity, setting);
  FrameCounts counts;
  const double rms = difference(drawn(texture, request, counts), exact).rms;
  return {rms, counts.samples_taken};
}

TEST(Adaptive, IsNearerThanSamplesAsMany) {
  struct Medium {
    const char* name;
    double (*opacity)(double);
  };
  for (const auto& [name, opacity] : {Medium{"spikes", spikes}, {"layer", layer}})
    for (const TexelType type : {TexelType::u16, TexelType::f32}) {
      Texture texture = sampled(describe({40, 40, 40}, type), sphere_field(0.3, 0.2));
      const ReferenceImage exact = integral(texture, request_of(texture, opacity, {}));
      const Result adaptive = result_of(texture, opacity, {Method::adaptive, 2, 3e-3F}, exact);
      // The coarsest sampling with at least as many samples.
      Result samples;
      double voxels = 2;
      for (; samples.samples < adaptive.samples; voxels /= 1.1)
        samples = result_of(texture, opacity, {Method::post_classified, voxels}, exact);
      std::printf("%s, texels %d: rms %.2e with %zu samples, adaptive; %.2e with %zu\n", name, int(type),
                  adaptive.rms, std::size_t(adaptive.samples), samples.rms, std::size_t(samples.samples));
      EXPECT_LE(adaptive.rms, samples.rms);
    }
}

TEST(Adaptive, IsNearerTheSmallerTheTolerance) {
  Texture texture = sampled(describe({40, 40, 40}, TexelType::f32), sphere_field(0.3, 0.2));
  const ReferenceImage exact = integral(texture, request_of(texture, spikes, {}));
  double last = 1;
  for (const float tolerance : {1.0F, 0.2F, 3e-2F}) {
    const Result result = result_of(texture, spikes, {Method::adaptive, 2, tolerance}, exact);
    std::printf("tolerance %g: rms %.2e with %zu samples\n", double(tolerance), result.rms,
                std::size_t(result.samples));
    EXPECT_LT(result.rms, 0.7 * last);
    last = result.rms;
  }
}

TEST(Adaptive, KeepsTheOrderOfItsSteps) {
  // On a field that the voxels represent exactly, without subdivision.
  Texture texture = sampled(describe({40, 40, 40}, TexelType::f32), linear_field({0.4, 0.3, 0.2}, 0.05));
  const ReferenceImage exact = integral(texture, request_of(texture, smooth, {}));
  std::vector<double> errors;
  for (const double voxels : {8.0, 4.0, 2.0, 1.0}) {
    const Result result = result_of(texture, smooth, {Method::adaptive, voxels, 10}, exact);
    errors.push_back(result.rms);
    std::printf("steps of %g voxels: rms %.2e\n", voxels, result.rms);
  }
  EXPECT_GE(std::log2(errors.front() / errors.back()) / 3, 1.8);
}

TEST(Adaptive, DividesNothingWhereTheFieldIsEven) {
  Texture texture = sampled(describe({40, 40, 40}, TexelType::u8), constant_field(0.4));
  const RenderRequest request = request_of(texture, spikes, {});
  FrameCounts counts;
  (void)drawn(texture, request, counts);
  EXPECT_LE(counts.samples_taken, counts.samples + counts.rays) << "a piece before a ray's first whole step";
}

TEST(Adaptive, IsTheSameForAnyPartition) {
  double worst = 0;
  for (int ranks = 2; ranks <= 8; ++ranks)
    for (const double voxels : {0.7, 2.0, 5.0}) {
      Texture texture = ranks % 2 == 0
                            ? noise(describe({40, 41, 43}, TexelType::u8), unsigned(ranks))
                            : sampled(describe({40, 41, 43}, TexelType::f32), sphere_field(0.3, 0.1));
      RenderRequest request = request_of(texture, spikes, {Method::adaptive, voxels, 1e-2F});
      request.clip_planes = {{{1, 0.3, -0.2}, -0.35}};
      request.window = request.viewport;
      FrameCounts one, many;
      const double d =
          difference(drawn(texture, request, one), drawn_in_parts(texture, request, ranks, many)).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, 1e-5) << ranks << " ranks, steps of " << voxels;
      EXPECT_EQ(one.samples, many.samples);
      EXPECT_GT(one.samples_taken, one.samples / 2) << "something is to be seen";
    }
  std::printf("2 to 8 ranks against 1: largest difference %.2e\n", worst);
}

TEST(Adaptive, IsTheSameOnAllInstructionSets) {
  const std::int64_t here = hwy::SupportedTargets();
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32})
    for (const bool cut : {false, true}) {
      Texture texture = sampled(describe({40, 37, 43}, type, Wrap::border), sphere_field(0.3, 0.2));
      RenderRequest request = request_of(texture, spikes, {Method::adaptive, 1.5, 1e-2F});
      request.window = request.viewport;
      if (cut) request.clip_planes = {{{1, 0.3, -0.2}, -0.35}};
      std::optional<Image> plain;
      for (const std::int64_t target : {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
        if (target != HWY_EMU128 && (here & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        FrameCounts counts;
        const Image image = drawn(texture, request, counts);
        if (!plain) plain = image;
        // The last bit of a value may decide how a step is divided.
        const Difference d = difference(image, *plain);
        EXPECT_LE(d.max, 5e-3) << instruction_set();
        EXPECT_LE(d.rms, 1e-4) << instruction_set();
      }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
}

TEST(Adaptive, StaysFiniteOnUnusualFields) {
  const std::vector<float> values{
      0, std::numeric_limits<float>::infinity(), 0.4F, -1e30F, 1, 1e30F, std::nanf(""), 1e-40F};
  Texture texture = noise(describe({13, 12, 11}, TexelType::f32), 3);
  for (std::size_t i = 0; i < texture.texels.size() / 4; ++i)
    std::memcpy(texture.texels.data() + 4 * i, &values[i % values.size()], 4);
  for (const double voxels : {0.5, 3.0, 12.0}) {
    const RenderRequest request = request_of(texture, spikes, {Method::adaptive, voxels});
    FrameCounts counts;
    for (const float v : drawn(texture, request, counts).rgba) ASSERT_TRUE(std::isfinite(v));
  }
}

TEST(Adaptive, StepsWithSurfacesOrLightAreRefused) {
  Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 1);
  const RenderRequest good = request_of(texture, spikes, {Method::adaptive, 0.5});
  texture.description.ghost_layer += 1;
  EXPECT_NO_THROW(validate(texture.description, good));
  const auto refused = [&](auto change) {
    RenderRequest bad = good;
    change(bad);
    EXPECT_THROW(validate(texture.description, bad), std::invalid_argument);
  };
  refused([](RenderRequest& r) { r.surfaces = {{0.5, {1, 1, 1, 1}}}; });
  refused([](RenderRequest& r) { r.light.emplace(); });
  refused([](RenderRequest& r) { r.tolerance = 0; });
  refused([](RenderRequest& r) { r.tolerance = NAN; });
  refused([](RenderRequest& r) { r.op = Operator::max; });
}

}  // namespace
}  // namespace understudy::volume::testing
