// SPDX-License-Identifier: Apache-2.0
#include "emulated_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace understudy::spu::testing {
namespace {

using emulation::Matrix;

constexpr int slices = 40;

Matrix translation(double x, double y, double z) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
}

/// Like glRotate about (0.2, 1, 0.1).
Matrix rotation(double degrees) {
  std::array<double, 3> axis = {0.2, 1, 0.1};
  const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  for (double& x : axis) x /= length;
  const auto [x, y, z] = axis;
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180), rest = 1 - c;
  return {x * x * rest + c,
          y * x * rest + z * s,
          z * x * rest - y * s,
          0,
          x * y * rest - z * s,
          y * y * rest + c,
          z * y * rest + x * s,
          0,
          x * z * rest + y * s,
          y * z * rest - x * s,
          z * z * rest + c,
          0,
          0,
          0,
          0,
          1};
}

constexpr double near = 1, far = 10;

/// glFrustum(-0.3, 0.3, -0.3, 0.3, 1, 10).
constexpr Matrix frustum = {near / 0.3,
                            0,
                            0,
                            0,
                            0,
                            near / 0.3,
                            0,
                            0,
                            0,
                            0,
                            -(far + near) / (far - near),
                            -1,
                            0,
                            0,
                            -2 * far* near / (far - near),
                            0};
/// glOrtho(-0.9, 0.9, -0.9, 0.9, 1, 10).
constexpr Matrix parallel_projection = {
    1 / 0.9, 0, 0, 0, 0, 1 / 0.9, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1};

emulation::Volume cube(double angle, bool front_to_back) {
  emulation::Volume volume;
  const Blob blob;
  volume.field.size = {blob.x, blob.y, blob.z};
  volume.clip_from_texture = cube_camera(angle);
  volume.normal = {0, 0, 1};
  for (int i = 0; i < slices; ++i)
    volume.offsets.push_back(((front_to_back ? slices - 1 - i : i) + 0.5) / slices);
  return volume;
}

/// The first `channels` channels of each pixel, top row first.
std::vector<double> top_down(const std::vector<float>& pixels, int channels) {
  constexpr std::size_t edge = GlApplication::size;
  std::vector<double> result;
  for (std::size_t y = edge; y-- > 0;)
    for (std::size_t x = 0; x < edge; ++x)
      for (std::size_t c = 0; c < std::size_t(channels); ++c) result.push_back(pixels[4 * (y * edge + x) + c]);
  return result;
}

}  // namespace

Matrix cube_camera(double angle, bool parallel, double sideways, double backwards) {
  Matrix matrix = emulation::product(parallel ? parallel_projection : frustum, translation(sideways, 0, -3));
  matrix = emulation::product(matrix, rotation(angle));
  matrix = emulation::product(matrix, translation(0, 0, -backwards));
  return emulation::product(matrix, translation(-0.5, -0.5, -0.5));
}

std::vector<double> blob_values() {
  return texels_of(Blob().texels(), [](int s) { return std::array{s / 255.0}; });
}

std::vector<double> blob_colours() {
  return texels_of(Blob().texels(), [](int s) {
    return std::array{s / 255.0, (255 - s) / 255.0, 90 / 255.0, std::floor(s * s / 255 / 5) / 255.0};
  });
}

emulation::Volume colour_cube(std::vector<double> colours, double angle, bool front_to_back) {
  emulation::Volume volume = cube(angle, front_to_back);
  volume.field.components = 4;
  volume.field.texels = std::move(colours);
  volume.factor = {1, 0.8F, 0.9F, 1};
  return volume;
}

emulation::Volume table_cube(std::vector<double> values, double angle, bool front_to_back) {
  emulation::Volume volume = cube(angle, front_to_back);
  volume.field.texels = std::move(values);
  for (int i = 0; i < 256; ++i) {
    const float s = float(i) / 255;
    volume.table.entries.push_back({s, 0.5F + 0.5F * std::sin(9 * s), 1 - s, 0.2F * s * s});
  }
  // texture1D(table, value): entry i lies at (i + 1/2) / 256.
  volume.table.scale = 256;
  volume.table.offset = -0.5;
  return volume;
}

emulation::Frame frame_of(std::vector<emulation::Volume> volumes, const emulation::Colour& background,
                          const emulation::Blending& blending) {
  emulation::Frame frame;
  frame.width = frame.height = GlApplication::size;
  frame.background = background;
  frame.volumes = std::move(volumes);
  frame.blending = blending;
  return frame;
}

int channels_outside(const emulation::Image& image, const std::vector<float>& pixels, int channels,
                     double slack) {
  return emulation::judge(image, top_down(pixels, channels), channels, slack).outside;
}

void expect_within(const char* what, const emulation::Image& image, const std::vector<float>& pixels,
                   int channels, double slack) {
  const std::vector<double> drawn = top_down(pixels, channels);
  const emulation::Verdict verdict = emulation::judge(image, drawn, channels, slack);
  std::printf("%s: RMS %.1e, max %.1e, beyond the bounds by %.1e (%d of %zu), RMS of the bounds %.1e\n", what,
              verdict.rms, verdict.max, verdict.beyond, verdict.outside, drawn.size(), verdict.width);
  EXPECT_EQ(verdict.outside, 0) << what;
}

emulation::Image shown_in_bytes(const emulation::Frame& frame, emulation::Precision precision) {
  return emulation::draw(frame, precision, {}, emulation::presented(emulation::normalised(8, 8)));
}

}  // namespace understudy::spu::testing
