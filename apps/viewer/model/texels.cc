// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/texels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace viewer {

namespace {

template <typename T>
T element(const std::vector<std::byte>& bytes, std::size_t index) {
  T value;
  std::memcpy(&value, bytes.data() + index * sizeof(T), sizeof(T));
  return value;
}

template <typename T>
void set_element(std::vector<std::byte>& bytes, std::size_t index, T value) {
  std::memcpy(bytes.data() + index * sizeof(T), &value, sizeof(T));
}

template <typename T>
void measure(const std::vector<std::byte>& voxels, Texels& texels) {
  const std::size_t count = voxels.size() / sizeof(T);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = element<T>(voxels, i);
    if (!std::isfinite(value)) {
      ++texels.not_finite;
      continue;
    }
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  if (lowest <= highest) {
    texels.lowest = lowest;
    texels.highest = highest;
  }
}

// A constant volume has no range; all its texels become 0.
double per_range(const Texels& texels) {
  const double range = texels.value_at_1 - texels.value_at_0;
  return range > 0 ? 1.0 / range : 0.0;
}

template <typename T>
void map_to_unorm16(const std::vector<std::byte>& voxels, Texels& texels) {
  measure<T>(voxels, texels);
  texels.format = TexelFormat::unorm16;
  texels.value_at_0 = texels.lowest;
  texels.value_at_1 = texels.highest;
  const std::size_t count = voxels.size() / sizeof(T);
  const double factor = 65535.0 * per_range(texels);
  std::vector<std::byte> data(count * sizeof(std::uint16_t));
  for (std::size_t i = 0; i < count; ++i)
    set_element(data, i,
                static_cast<std::uint16_t>(std::lround((element<T>(voxels, i) - texels.value_at_0) * factor)));
  texels.data = std::move(data);
}

void map_float(std::vector<std::byte> voxels, Texels& texels) {
  measure<float>(voxels, texels);
  texels.format = TexelFormat::float32;
  texels.value_at_0 = texels.lowest;
  texels.value_at_1 = texels.highest;
  const double factor = per_range(texels);
  const std::size_t count = voxels.size() / sizeof(float);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = element<float>(voxels, i);
    set_element(voxels, i,
                std::isfinite(value) ? static_cast<float>((value - texels.value_at_0) * factor) : 0.0F);
  }
  texels.data = std::move(voxels);
}

}  // namespace

Texels to_texels(Volume volume) {
  Texels texels;
  texels.size = volume.size;
  texels.spacing = volume.spacing;
  switch (volume.type) {
    case ScalarType::u8:
      measure<std::uint8_t>(volume.voxels, texels);
      texels.data = std::move(volume.voxels);
      break;
    case ScalarType::i8:
      map_to_unorm16<std::int8_t>(volume.voxels, texels);
      break;
    case ScalarType::u16:
      map_to_unorm16<std::uint16_t>(volume.voxels, texels);
      break;
    case ScalarType::i16:
      map_to_unorm16<std::int16_t>(volume.voxels, texels);
      break;
    case ScalarType::f32:
      map_float(std::move(volume.voxels), texels);
      break;
  }
  return texels;
}

double texel_value(const Texels& texels, std::size_t index) {
  switch (texels.format) {
    case TexelFormat::unorm8:
      return element<std::uint8_t>(texels.data, index) / 255.0;
    case TexelFormat::unorm16:
      return element<std::uint16_t>(texels.data, index) / 65535.0;
    case TexelFormat::float32:
      return element<float>(texels.data, index);
  }
  return 0;
}

}  // namespace viewer
