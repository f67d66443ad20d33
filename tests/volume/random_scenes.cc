// SPDX-License-Identifier: Apache-2.0
#include "tests/volume/random_scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "tests/volume/scenes.h"
#include "volume/raycast/segment_scene.h"

namespace understudy::volume::testing {

namespace {

constexpr unsigned usual_seed = 20110;
constexpr int widest = 40, most_samples = 90;

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

int whole(std::mt19937& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

bool happens(std::mt19937& random, double probability) {
  return uniform(random, 0, 1) < probability;
}

template <typename T, std::size_t n>
T one_of(std::mt19937& random, const std::array<T, n>& all) {
  return all[std::size_t(whole(random, 0, int(n) - 1))];
}

Texture random_texture(std::mt19937& random) {
  std::array<int, 3> size{};
  for (int& n : size) n = happens(random, 0.15) ? 1 : whole(random, 2, widest);
  const TexelType type =
      one_of(random, std::array{TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8});
  const Wrap wrap = one_of(random, std::array{Wrap::edge, Wrap::border, Wrap::repeat});
  return noise(describe(size, type, wrap), unsigned(random()));
}

void make_wild(std::mt19937& random, Texture& texture) {
  using Limits = std::numeric_limits<float>;
  const std::array values{Limits::quiet_NaN(),
                          Limits::infinity(),
                          -Limits::infinity(),
                          Limits::max(),
                          -Limits::max(),
                          1e30F,
                          -1e30F,
                          Limits::denorm_min(),
                          -0.0F};
  const double share = one_of(random, std::array{0.01, 0.3, 1.0});
  const bool numbers_alone = happens(random, 0.5);
  for (std::size_t i = 0; i < stored_texels(texture.description); ++i)
    if (happens(random, share)) {
      const float value = one_of(random, values);
      if (numbers_alone && std::isnan(value)) continue;
      std::memcpy(texture.texels.data() + i * sizeof value, &value, sizeof value);
    }
}

/// Opacities of all magnitudes, and steps between them; colours of a medium, or emission beyond that.
TransferFunction random_table(std::mt19937& random, bool medium) {
  TransferFunction table;
  const int entries = one_of(random, std::array{2, 3, 17, 256, 300});
  const int kind = whole(random, 0, 3);
  for (int i = 0; i < entries; ++i) {
    const double of_kind[] = {uniform(random, 0, 1), std::pow(10, uniform(random, -12, 0)),
                              happens(random, 0.5) ? 1.0 : 0.0, 0.3 * i / entries};
    const auto alpha = float(of_kind[kind]);
    Rgba& entry = table.entries.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      entry[k] = float(uniform(random, 0, 1)) * (medium ? alpha : float(uniform(random, 0, 2)));
    entry[3] = alpha;
  }
  if (happens(random, 0.3)) {
    table.low = float(uniform(random, -0.5, 0.6));
    table.high = table.low + float(uniform(random, 0.05, 1));
  }
  return table;
}

double steepness_of(const TransferFunction& table) {
  double most = 0;
  for (std::size_t i = 1; i < table.entries.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      most = std::max(most, std::abs(double(table.entries[i][k]) - double(table.entries[i - 1][k])));
  return most * double(table.entries.size() - 1) / double(table.high - table.low);
}

Matrix4 random_camera(std::mt19937& random, double aspect) {
  const double far = one_of(random, std::array{0.4, 2.0, 5.0});
  const Vec3 eye{far * uniform(random, -1, 1), far * uniform(random, -1, 1), far * uniform(random, -1, 1)};
  const Vec3 centre{uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4)};
  const double mirror = happens(random, 0.3) ? -1 : 1;
  const Matrix4 model{mirror,
                      uniform(random, -0.3, 0.3),
                      0,
                      0,
                      0,
                      1,
                      uniform(random, -0.4, 0.4),
                      0,
                      0,
                      0,
                      uniform(random, 0.2, 1.5),
                      0,
                      0,
                      0,
                      0,
                      1};
  const Matrix4 projection = happens(random, 0.7) ? perspective(uniform(random, 20, 80), aspect, 0.02, 20)
                                                  : parallel(0.8 * aspect, 0.8, -8, 8);
  return multiply(projection, multiply(look_at(eye, centre, {0.1, 1, 0.3}), multiply(model, unit_cube())));
}

}  // namespace

unsigned test_seed() {
  const char* const given = std::getenv("UNDERSTUDY_TEST_SEED");
  return given != nullptr ? unsigned(std::strtoul(given, nullptr, 10)) : usual_seed;
}

RandomScene random_scene(std::mt19937& random) {
  RandomScene scene;
  scene.texture = random_texture(random);
  const VolumeDescription& description = scene.texture.description;
  if (description.type == TexelType::f32 && happens(random, 0.5)) {
    scene.wild_texels = true;
    make_wild(random, scene.texture);
  }
  const int width = whole(random, 1, 40), height = whole(random, 1, 30);
  RenderRequest& request = scene.request;
  request = request_for(scene.texture, random_camera(random, double(width) / height), width, height,
                        whole(random, 1, most_samples));
  if (description.type == TexelType::rgba8) {
    scene.coloured_medium = true;  // texels are clamped, and their colour is multiplied by alpha
    scene.steepness = 2;
  } else {
    scene.coloured_medium = happens(random, 0.7);
    const TransferFunction table = random_table(random, scene.coloured_medium);
    scene.steepness = steepness_of(table);
    request.classification = table;
  }
  request.op =
      one_of(random, std::array{Operator::over, Operator::over, Operator::max, Operator::min, Operator::add});
  request.filter = happens(random, 0.8) ? Filter::linear : Filter::nearest;
  if (happens(random, 0.5)) {
    RaySteps& steps = request.steps.emplace();
    const double length = 1.7 / whole(random, 3, most_samples);
    steps.metric = {1 / length, 0, 0, 0, 1 / length, 0, 0, 0, 1 / length};
    steps.first = uniform(random, 0, 1);
    steps.divided = happens(random, 0.3);
  }
  if (happens(random, 0.3))
    request.region = {{uniform(random, 0, 0.3), uniform(random, 0, 0.3), uniform(random, 0, 0.3)},
                      {uniform(random, 0.5, 1), uniform(random, 0.5, 1), uniform(random, 0.5, 1)}};
  if (happens(random, 0.3))
    request.clip_planes = {
        {{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}, uniform(random, -0.5, 0.5)}};
  if (request.steps && request.op == Operator::over && request.filter == Filter::linear &&
      description.type != TexelType::rgba8 && happens(random, 0.5)) {
    request.method = Method::pre_integrated;
    scene.texture.description.ghost_layer = ghost_layer_needed(description, request);
  }
  scene.text = fmt::format(
      "{}x{}x{} texels of type {}{}, wrap {}, {} filter, operator {}, {}, {}x{} pixels, steepness {:.3g}",
      description.size[0], description.size[1], description.size[2], int(description.type),
      scene.wild_texels ? " (wild)" : "", int(description.wrap[0]),
      request.filter == Filter::linear ? "linear" : "nearest", int(request.op),
      request.method == Method::pre_integrated ? "segments"
      : request.steps                          ? "steps"
                                               : "planes",
      width, height, scene.steepness);
  return scene;
}

}  // namespace understudy::volume::testing
