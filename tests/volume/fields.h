// SPDX-License-Identifier: Apache-2.0
// Fields with known values, and textures made from them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/description.h"
#include "volume/texture_space.h"

namespace understudy::volume::testing {

/// A scalar in [0, 1] over texture space.
using ScalarField = std::function<double(const Vec3& t)>;

inline ScalarField constant_field(double value) {
  return [value](const Vec3&) { return value; };
}

inline ScalarField linear_field(const Vec3& gradient, double offset) {
  return [=](const Vec3& t) { return gradient[0] * t[0] + gradient[1] * t[1] + gradient[2] * t[2] + offset; };
}

/// 1 in a ball of the given radius around the centre, 0 outside, with a smooth rim.
inline ScalarField sphere_field(double radius, double rim = 0.05) {
  return [=](const Vec3& t) {
    const double r = std::hypot(t[0] - 0.5, t[1] - 0.5, t[2] - 0.5);
    return 0.5 - 0.5 * std::tanh((r - radius) / rim);
  };
}

/// The test signal of Marschner and Lobb 1994, alpha = 0.25, with frequency 6 over the unit cube.
inline ScalarField marschner_lobb_field() {
  return [](const Vec3& t) {
    const double x = 2 * t[0] - 1, y = 2 * t[1] - 1, z = 2 * t[2] - 1, alpha = 0.25;
    const double rho = std::cos(2 * std::numbers::pi * 6 * std::cos(std::numbers::pi * std::hypot(x, y) / 2));
    return (1 - std::sin(std::numbers::pi * z / 2) + alpha * (1 + rho)) / (2 * (1 + alpha));
  };
}

/// A texture with its texels, those of `stored` only.
struct Texture {
  VolumeDescription description;
  std::vector<std::byte> texels;
};

inline VolumeDescription describe(std::array<int, 3> size, TexelType type, Wrap wrap = Wrap::edge) {
  VolumeDescription d;
  d.id = 7;
  d.size = size;
  d.type = type;
  d.wrap = {wrap, wrap, wrap};
  d.border = {0.7F, 0.2F, 0.4F, 0.6F};
  d.stored = {{0, 0, 0}, size};
  return d;
}

inline std::size_t stored_texels(const VolumeDescription& d) {
  std::size_t n = 1;
  for (int k = 0; k < 3; ++k) n *= std::size_t(d.stored.high[k] - d.stored.low[k]);
  return n;
}

/// Writes one texel from four components in [0, 1]; scalar types take the first.
inline void put_texel(Texture& texture, std::size_t index, const std::array<double, 4>& value) {
  const TexelType type = texture.description.type;
  std::byte* to = texture.texels.data() + index * bytes_per_texel(type);
  const auto quantised = [](double v, double top) { return std::lround(std::clamp(v, 0.0, 1.0) * top); };
  switch (type) {
    case TexelType::u8:
      *to = std::byte(quantised(value[0], 255));
      break;
    case TexelType::rgba8:
      for (int k = 0; k < 4; ++k) to[k] = std::byte(quantised(value[k], 255));
      break;
    case TexelType::u16: {
      const auto v = std::uint16_t(quantised(value[0], 65535));
      std::memcpy(to, &v, sizeof v);
      break;
    }
    case TexelType::f32: {
      const auto v = float(value[0]);
      std::memcpy(to, &v, sizeof v);
      break;
    }
  }
}

/// `field` sampled at the texel centres; the components of colour texels are four different functions of it.
inline Texture sampled(const VolumeDescription& description, const ScalarField& field) {
  Texture texture{description,
                  std::vector<std::byte>(stored_texels(description) * bytes_per_texel(description.type))};
  std::size_t index = 0;
  const TexelBox& s = description.stored;
  for (int z = s.low[2]; z < s.high[2]; ++z)
    for (int y = s.low[1]; y < s.high[1]; ++y)
      for (int x = s.low[0]; x < s.high[0]; ++x) {
        const double v = field({(x + 0.5) / description.size[0], (y + 0.5) / description.size[1],
                                (z + 0.5) / description.size[2]});
        put_texel(texture, index++, {v, 1 - v, v * v, 0.3 * v});
      }
  return texture;
}

/// Independent random texels, so that a wrong neighbour is always noticed.
inline Texture noise(const VolumeDescription& description, unsigned seed) {
  Texture texture{description,
                  std::vector<std::byte>(stored_texels(description) * bytes_per_texel(description.type))};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < stored_texels(description); ++i)
    put_texel(texture, i, {uniform(random), uniform(random), uniform(random), 0.3 * uniform(random)});
  return texture;
}

inline BrickStore filled(const Texture& texture, const TexelBox& cells) {
  BrickStore store(texture.description, cells);
  store.add_slices(texture.description.stored, texture.texels);
  store.finish();
  return store;
}

inline BrickStore filled(const Texture& texture) {
  return filled(texture, cell_lattice(texture.description).box());
}

}  // namespace understudy::volume::testing
