// SPDX-License-Identifier: Apache-2.0
// Samples that cover their whole rays: the midpoint rule up to the very end of each ray.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <vector>

#include "tests/volume/parts.h"
#include "volume/opacity_correction.h"
#include "volume/orbit_camera.h"
#include "volume/reference/pixel_integral.h"

namespace understudy::volume::testing {
namespace {

/// Colour and opacity of a layer of `length` steps, where `sample` is that of one step.
std::array<double, 4> layer(const std::array<double, 4>& sample, double length) {
  const double alpha = 1 - std::pow(1 - sample[3], length);
  const double share = sample[3] > 0 ? alpha / sample[3] : length;
  return {share * sample[0], share * sample[1], share * sample[2], alpha};
}

std::array<double, 4> sample_of(const TransferFunction& table, double value) {
  const double place = std::clamp((value - table.low) / (double(table.high) - table.low), 0.0, 1.0) *
                       double(table.entries.size() - 1);
  const auto below = std::min(std::size_t(place), table.entries.size() - 2);
  std::array<double, 4> sample{};
  for (std::size_t k = 0; k < 4; ++k)
    sample[k] =
        std::lerp(double(table.entries[below][k]), double(table.entries[below + 1][k]), place - double(below));
  return sample;
}

/// The definition, in double precision.
ReferenceImage expected(const Field& field, const RenderRequest& request) {
  ReferenceImage image{request.window, std::vector<double>(4 * request.window.pixels(), 0)};
  for (int y = 0; y < request.window.height; ++y)
    for (int x = 0; x < request.window.width; ++x) {
      const auto ray = pixel_ray(request, x, y);
      if (!ray) continue;
      const double count = std::max(1.0, std::floor(ray->length - 0.5) + 1);
      double* const pixel =
          image.rgba.data() + 4 * (std::size_t(y) * std::size_t(request.window.width) + std::size_t(x));
      for (int i = 0; i < int(count); ++i) {
        const double place = ray->length < 1 ? ray->length / 2 : i + 0.5;
        const double length = i + 1 < int(count) ? 1 : ray->length - i;
        const auto shown = layer(sample_of(std::get<TransferFunction>(request.classification),
                                           field(ray->at(place / ray->length))[0]),
                                 length);
        const double room = 1 - pixel[3];
        for (std::size_t k = 0; k < 4; ++k) pixel[k] += room * shown[k];
      }
    }
  return image;
}

RenderRequest whole_ray_request(const Texture& texture, const OrbitCamera& camera, double step) {
  RenderRequest request = orbit_request(texture.description, {1, 1, 1}, camera, 61, 53, step);
  request.classification = smooth_table();
  request.termination = 0;
  request.steps->cover_whole_ray = true;
  return request;
}

std::vector<RenderRequest> requests_of(const Texture& texture) {
  std::vector<RenderRequest> all;
  for (const double step : {0.3, 1.0, 2.7, 60.0}) all.push_back(whole_ray_request(texture, {33, 21, 3}, step));
  all.push_back(whole_ray_request(texture, {-60, 10, 0.4}, 1));  // the eye is inside
  all.push_back(whole_ray_request(texture, {33, 21, 3}, 1));
  all.back().clip_planes = {{{1, 0.3, -0.2}, -0.4}, {{-0.2, -1, 0.1}, 0.7}};
  all.push_back(whole_ray_request(texture, {33, 21, 3}, 1.3));
  all.back().region = {{0.1, 0.2, 0}, {0.9, 1, 0.7}};
  all.push_back(whole_ray_request(texture, {33, 21, 3}, 0.8));
  DepthImage& depth = all.back().depth.emplace();
  depth.rect = all.back().window;
  for (std::size_t i = 0; i < depth.rect.pixels(); ++i) depth.depth.push_back(0.3F + 0.5F * float(i % 61) / 61);
  return all;
}

TEST(WholeRays, ShowTheMidpointRuleToTheirEnd) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
    const Texture texture = noise(describe({23, 31, 27}, type), 11);
    const Field field = texture_field(texture.description, Filter::linear, texture.texels);
    int i = 0;
    for (RenderRequest request : requests_of(texture)) {
      const Whole whole = render_whole(texture, request);
      const Difference d = difference(whole.image, expected(field, request), 1e-3);
      std::printf("request %d: largest %.1e, rms %.1e\n", i, d.max, d.rms);
      // One sample more or less, where the last one begins to represent a step and a half, changes almost
      // nothing.
      EXPECT_LE(d.max, 2e-3) << i;
      EXPECT_LE(d.rms, 2e-5) << i;
      request.steps->cover_whole_ray = false;
      EXPECT_GT(difference(render_whole(texture, request).image, expected(field, request)).rms, 1e-3) << i;
      ++i;
    }
  }
}

TEST(WholeRays, AreTheSameForEveryPartition) {
  const Texture texture = noise(describe({23, 31, 27}, TexelType::u8), 12);
  for (const RenderRequest& request : requests_of(texture)) {
    const Whole whole = render_whole(texture, request);
    for (const int ranks : {2, 3, 7}) {
      const Whole parts = render_parts(texture, request, ranks);
      EXPECT_EQ(parts.counts.samples, whole.counts.samples);
      EXPECT_LE(difference(parts.image, whole.image).max, 1e-5);
    }
  }
}

/// A field that voxels represent exactly, visible up to the volume's sides.
TEST(WholeRays, ConvergeWithOrderTwoWhereRaysLeaveInsideOfSomethingVisible) {
  const Texture texture =
      sampled(describe({33, 33, 33}, TexelType::f32), linear_field({0.3, 0.25, 0.35}, 0.05));
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  TransferFunction of_voxel;
  for (int i = 0; i < 4096; ++i) {
    const double v = i / 4095.0;
    const auto alpha = float(-std::expm1(-0.06 * v * v));
    of_voxel.entries.push_back({alpha * float(v), alpha * float(1 - v), 0.5F * alpha, alpha});
  }
  const auto rms = [&](double step, bool whole_rays) {
    RenderRequest request = whole_ray_request(texture, {33, 21, 3}, step);
    request.steps->cover_whole_ray = whole_rays;
    request.classification = opacity_corrected(of_voxel, step, 4096);
    const Image image = render_whole(texture, request).image;
    RenderRequest unit = whole_ray_request(texture, {33, 21, 3}, 1);
    const Medium medium = Medium::of_samples(of_voxel, 1);
    double sum = 0;
    int count = 0;
    for (int y = 0; y < 53; y += 4)
      for (int x = 0; x < 61; x += 4, ++count) {
        const auto exact = pixel_integral(field, texture.description.size, unit, medium, x, y);
        for (std::size_t k = 0; k < 4; ++k) sum += std::pow(double(image.at(x, y)[k]) - exact[k], 2);
      }
    return std::sqrt(sum / (4 * count));
  };
  const double coarse = rms(1, true), fine = rms(0.25, true);
  std::printf("steps of 1 and 1/4: rms %.2e and %.2e, order %.2f; otherwise %.2e and %.2e\n", coarse, fine,
              std::log2(coarse / fine) / 2, rms(1, false), rms(0.25, false));
  EXPECT_GE(std::log2(coarse / fine) / 2, 1.8);
  EXPECT_GT(rms(1, false), 10 * coarse);
  EXPECT_GT(rms(0.25, false), 100 * fine);
}

TEST(WholeRays, OfWhatHasNoSuchMeaningAreRefused) {
  const Texture texture = noise(describe({23, 31, 27}, TexelType::u8), 13);
  const RenderRequest good = whole_ray_request(texture, {33, 21, 3}, 1);
  const BrickStore store = filled(texture);
  Image image(good.window);
  FrameCounts counts;
  const auto refused = [&](auto change) {
    RenderRequest request = good;
    change(request);
    EXPECT_FALSE(may_cover_whole_rays(request));
    EXPECT_THROW(raycast(store, request, image, counts), std::invalid_argument);
  };
  EXPECT_TRUE(may_cover_whole_rays(good));
  refused([](RenderRequest& r) { r.op = Operator::max; });
  refused([](RenderRequest& r) { r.steps->first = 0; });
  refused([](RenderRequest& r) { r.steps->divided = true; });
  refused([](RenderRequest& r) { r.steps->past_depth = 1; });
  refused([](RenderRequest& r) { r.steps->counted_from = 0.5; });
  refused([](RenderRequest& r) { r.filter = Filter::nearest; });
  refused([](RenderRequest& r) { r.opacity_limit = 0.9F; });
  refused([](RenderRequest& r) { r.method = Method::pre_integrated; });
}

}  // namespace
}  // namespace understudy::volume::testing
