// SPDX-License-Identifier: Apache-2.0
// Order of accuracy: how fast the error of the volume rendering integral decreases when steps are halved. It is
// a slope over at least four halvings and many rays, for smooth procedural fields and smooth transfer
// functions; voxel fields have kinks, for which no order is guaranteed. (Etiene et al. 2014 verify renderers in
// this way.)
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <vector>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

constexpr int edge = 8;  ///< of the image, in rays
constexpr std::array<int, 5> steps{16, 32, 64, 128, 256};

double extinction(double s) {
  return 6 * s * s;
}
std::array<double, 3> colour(double s) {
  return {0.2 + 0.7 * s, 0.9 - 0.8 * s * s, 0.5 + 0.4 * std::sin(3 * s)};
}

/// Colour and opacity of a homogeneous layer as thick as one of `count` steps.
TransferFunction table_for(int count) {
  constexpr int entries = 4096;
  TransferFunction table;
  for (int i = 0; i < entries; ++i) {
    const double s = double(i) / (entries - 1);
    const double alpha = -std::expm1(-extinction(s) / count);
    Rgba& entry = table.entries.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) entry[k] = float(colour(s)[k] * alpha);
    entry[3] = float(alpha);
  }
  return table;
}

/// Parallel rays along z through the depths [low, high], divided into `count` steps.
RenderRequest rays_along_z(int count, double low = 0, double high = 1) {
  RenderRequest request;
  request.viewport = request.window = {0, 0, edge, edge};
  request.texture_to_clip = {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1};
  request.region = {{0, 0, low}, {1, 1, high}};
  request.steps.emplace();
  request.steps->metric = {1, 0, 0, 0, 1, 0, 0, 0, count / (high - low)};
  request.classification = table_for(count);
  request.termination = 0;
  return request;
}

Vec3 on_ray(const RenderRequest& request, int x, int y, double way) {
  return {(x + 0.5) / edge, (y + 0.5) / edge,
          request.region.low[2] + way * (request.region.high[2] - request.region.low[2])};
}

/// The integral along every ray of unit length: Gauss-Legendre on pieces short enough that only double
/// precision limits it.
ReferenceImage integral(const ScalarField& field, const RenderRequest& request) {
  constexpr int pieces = 2000;
  // Nodes of order 6; the extinction up to each node is integrated by the same rule.
  constexpr std::array<double, 3> nodes{0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
  ReferenceImage image{request.window, {}};
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const auto value = [&](double way) { return field(on_ray(request, x, y, way)); };
      double depth = 0;
      std::array<double, 3> seen{};
      for (int i = 0; i < pieces; ++i) {
        const auto depth_until = [&](double part) {
          double sum = 0;
          for (std::size_t j = 0; j < 3; ++j)
            sum += weights[j] * extinction(value((i + part * nodes[j]) / pieces));
          return depth + part * sum / pieces;
        };
        for (std::size_t j = 0; j < 3; ++j) {
          const double s = value((i + nodes[j]) / pieces);
          const double light = weights[j] * std::exp(-depth_until(nodes[j])) * extinction(s) / pieces;
          for (std::size_t k = 0; k < 3; ++k) seen[k] += light * colour(s)[k];
        }
        depth = depth_until(1);
      }
      image.rgba.insert(image.rgba.end(), {seen[0], seen[1], seen[2], -std::expm1(-depth)});
    }
  return image;
}

double rms(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / double(a.size()));
}

/// The slope of log error over log step, by least squares.
double order(const std::vector<double>& errors) {
  double xx = 0, xy = 0, mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    mean_x -= std::log2(steps[i]) / double(errors.size());
    mean_y += std::log2(errors[i]) / double(errors.size());
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double x = -std::log2(steps[i]) - mean_x;
    xx += x * x;
    xy += x * (std::log2(errors[i]) - mean_y);
  }
  return xy / xx;
}

void print(const char* scheme, const std::vector<double>& errors) {
  std::printf("%-36s rms", scheme);
  for (const double error : errors) std::printf(" %.1e", error);
  std::printf(", order %.2f\n", order(errors));
}

const ScalarField waves = [](const Vec3& t) {
  constexpr double pi = std::numbers::pi;
  return 0.5 + 0.25 * std::sin(2 * pi * (t[2] + 0.6 * t[0])) + 0.2 * std::cos(pi * (1.3 * t[2] - t[1]) + 1);
};

std::vector<double> errors_on_waves(double first, Method method) {
  const Field field = [](const Vec3& t) { return std::array<double, 4>{waves(t), 0, 0, 0}; };
  const VolumeDescription volume = describe({8, 8, 8}, TexelType::f32);
  const ReferenceImage exact = integral(waves, rays_along_z(1));
  std::vector<double> errors;
  for (const int count : steps) {
    RenderRequest request = rays_along_z(count);
    request.steps->first = first;
    request.method = method;
    const ReferenceImage image = method == Method::pre_integrated
                                     ? segment_sum(field, volume, request, request.window)
                                     : slice_sum(field, request, request.window);
    errors.push_back(rms(image.rgba, exact.rgba));
  }
  return errors;
}

TEST(Order, OfSamplesInTheMiddleOfTheirStepsIsTwo) {
  const auto errors = errors_on_waves(0.5, Method::post_classified);
  print("samples in the middle of steps", errors);
  EXPECT_GE(order(errors), 1.8);
}

TEST(Order, OfSamplesAtTheEndsOfTheirStepsIsOne) {
  // Slightly after the beginning of the step: otherwise the end of the ray would be an additional sample.
  const auto errors = errors_on_waves(1e-9, Method::post_classified);
  print("samples where steps begin", errors);
  EXPECT_GE(order(errors), 0.8);
  EXPECT_LE(order(errors), 1.5) << "better than theory: the scene does not show the order";
}

TEST(Order, OfPreIntegratedSegmentsIsTwo) {
  const auto errors = errors_on_waves(0, Method::pre_integrated);
  print("pre-integrated segments", errors);
  EXPECT_GE(order(errors), 1.8);
}

/// A field that voxels represent exactly, drawn by the ray caster itself.
TEST(Order, OfTheRayCasterOnAFieldWithoutKinks) {
  const ScalarField ramp = linear_field({0.15, 0.2, 0.55}, 0.05);
  Texture texture = sampled(describe({33, 29, 31}, TexelType::f32), ramp);
  const double rim = 0.5 / 31;  // beyond the outermost texels' centres the field is constant
  const auto request_of = [&](int count) {
    RenderRequest request = rays_along_z(count, rim, 1 - rim);
    request.volume = texture.description.id;
    request.window = {1, 1, edge - 2, edge - 2};
    return request;
  };
  std::vector<double> by_samples, by_segments;
  for (const int count : steps) {
    RenderRequest request = request_of(count);
    const ReferenceImage whole = integral(ramp, request);
    std::vector<double> exact;
    const auto error_of = [&](const Image& image) {
      std::vector<double> got;
      exact.clear();
      for (int y = request.window.y; y < request.window.y + request.window.height; ++y)
        for (int x = request.window.x; x < request.window.x + request.window.width; ++x)
          for (std::size_t k = 0; k < 4; ++k) {
            got.push_back(double(image.at(x, y)[k]));
            exact.push_back(whole.rgba[4 * std::size_t(y * edge + x) + k]);
          }
      return rms(got, exact);
    };
    FrameCounts counts;
    request.steps->first = 0.5;
    by_samples.push_back(error_of(drawn(texture, request, counts)));
    request.steps->first = 0;
    request.method = Method::pre_integrated;
    give_ghost_layer(texture, request);
    by_segments.push_back(error_of(drawn(texture, request, counts)));
  }
  print("ray caster, samples", by_samples);
  EXPECT_GE(order(by_samples), 1.8);
  print("ray caster, segments (exact here)", by_segments);
  for (const double error : by_segments) EXPECT_LE(error, 1e-4) << "an even field is what segments take it for";
}

}  // namespace
}  // namespace understudy::volume::testing
