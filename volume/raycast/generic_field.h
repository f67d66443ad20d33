// SPDX-License-Identifier: Apache-2.0
// The field as the generic kernels read it: one position at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "volume/raycast/kernel.h"
#include "volume/rgba.h"
#include "volume/texture_filter.h"

namespace understudy::volume {

/// A sample of the field in units of the texel type: one component, or RGBA.
template <typename Texel>
struct StoredTexels {
  using Sample = float;
  static Sample read(const std::byte* block, int index) {
    Texel texel;
    std::memcpy(&texel, block + std::size_t(index) * sizeof texel, sizeof texel);
    return float(texel);
  }
  static Sample border(const Rgba& rgba) { return rgba[0]; }
  static Sample mix(Sample a, Sample b, float s) { return a + s * (b - a); }
};

struct Colours {
  using Sample = Rgba;
  static Sample read(const std::byte* block, int index) {
    std::array<std::uint8_t, 4> texel;
    std::memcpy(texel.data(), block + std::size_t(index) * sizeof texel, sizeof texel);
    return {float(texel[0]), float(texel[1]), float(texel[2]), float(texel[3])};
  }
  static Sample border(const Rgba& rgba) { return rgba; }
  static Sample mix(const Sample& a, const Sample& b, float s) {
    Sample mixed;
    for (std::size_t k = 0; k < 4; ++k) mixed[k] = a[k] + s * (b[k] - a[k]);
    return mixed;
  }
};

/// Colour and opacity of a scalar sample; false when it contributes nothing (NaN).
inline bool classify(const Scene& scene, float value, Rgba& colour) {
  if (std::isnan(value)) return false;
  const TransferTable& table = *scene.table;
  const float position = std::clamp((value - table.low()) * table.scale(), 0.0F, table.last());
  const auto entry = std::size_t(position);
  const float fraction = position - float(entry);
  const float* row = table.rows() + 8 * entry;
  for (std::size_t k = 0; k < 4; ++k) colour[k] = row[k] + fraction * row[4 + k];
  return true;
}

/// Converts the colour of a layer one step long to that of a layer of `length` steps.
inline void resize_layer(float length, Rgba& colour) {
  if (length == 1) return;
  const float opacity = colour[3];
  const float kept = length > 0 ? -std::expm1(length * std::log1p(-std::min(opacity, 1.0F))) : 0;
  const float ratio = opacity > 0 ? kept / opacity : length;
  for (std::size_t k = 0; k < 3; ++k) colour[k] *= ratio;
  colour[3] = kept;
}

/// Interpolates a pre-integration table at a position within it.
inline Rgba interpolated(const PreIntegrationLookup& pairs, float x, float y) {
  const auto entry = [&](float at) { return std::min(std::size_t(at), std::size_t(pairs.edge()) - 2); };
  const std::size_t i = entry(x), j = entry(y);
  const float* lower = pairs.entries() + 4 * (j * std::size_t(pairs.edge()) + i);
  const float* upper = lower + 4 * std::size_t(pairs.edge());
  Rgba colour;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto along = [&](const float* row) { return row[k] + (x - float(i)) * (row[4 + k] - row[k]); };
    colour[k] = along(lower) + (y - float(j)) * (along(upper) - along(lower));
  }
  return colour;
}

/// Colour and opacity of a segment; false when it contributes nothing (NaN).
inline bool classify(const PreIntegrationLookup& pairs, float front, float back, Rgba& colour) {
  if (std::isnan(front) || std::isnan(back)) return false;
  const auto place = [&](float value) {
    return std::clamp((value - pairs.low()) * pairs.scale(), 0.0F, pairs.last());
  };
  colour = interpolated(pairs, place(front), place(back));
  if (pairs.multiply_by_alpha())
    for (std::size_t k = 0; k < 3; ++k) colour[k] *= colour[3];
  return true;
}

/// Reads the field at one position, which must lie where the scene's store holds texels.
template <typename FieldType>
class FieldReader {
 public:
  explicit FieldReader(const Scene& scene) : scene_(scene) {}

  /// Clamps the position to the box from `low` to `high`.
  void move_to(const std::array<float, 3>& position, const std::array<float, 3>& low,
               const std::array<float, 3>& high) {
    position_ = position;
    for (std::size_t axis = 0; axis < 3; ++axis)
      clamped_[axis] = std::clamp(position[axis], low[axis], high[axis]);
    find_cell();
  }

  const std::array<float, 3>& position() const { return position_; }
  std::size_t block() const { return block_; }

  /// Lower bound of the number of steps from here in empty bricks; negative in a block that shows something.
  float steps_in_empty(const std::array<float, 3>& step) const {
    const int distance = scene_.skip->distances()[block_];
    if (distance == 0) return -1;
    // All blocks fewer than `distance` blocks away are empty. Rounding must not lead past their faces.
    float most = 1e9F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = std::floor(clamped_[axis] / 8) * 8;
      const float room = step[axis] > 0 ? low + 8 * float(distance) - clamped_[axis]
                                        : clamped_[axis] - low + 8 * float(distance - 1);
      const float speed = std::max(std::abs(step[axis]), 1e-20F);
      most = std::min(most, (room - scene_.rounding[axis]) / speed * (1 - 1e-6F));
    }
    return std::max(most, 0.0F);
  }

  typename FieldType::Sample sample() const {
    const std::byte* block = scene_.store->block_data()[block_];
    constexpr int y = BrickStore::block_row, z = BrickStore::block_slice;
    if constexpr (std::is_same_v<FieldType, StoredTexels<std::uint8_t>>)
      if (scene_.filter == Filter::linear_8_bit) return rounded_sample(block);
    if (scene_.filter == Filter::nearest) {
      const int texel = corner_ + (fraction_[0] >= 0.5F ? 1 : 0) + (fraction_[1] >= 0.5F ? y : 0) +
                        (fraction_[2] >= 0.5F ? z : 0);
      return FieldType::read(block, texel);
    }
    const auto along_x = [&](int i) {
      return FieldType::mix(FieldType::read(block, i), FieldType::read(block, i + 1), fraction_[0]);
    };
    const auto inside = FieldType::mix(
        FieldType::mix(along_x(corner_), along_x(corner_ + y), fraction_[1]),
        FieldType::mix(along_x(corner_ + z), along_x(corner_ + y + z), fraction_[1]), fraction_[2]);
    // Beyond the outermost texel centres the filter blends in a constant, one axis at a time, so the weights
    // multiply.
    float weight = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (scene_.has_border[axis]) weight *= std::max(0.0F, 1 - std::abs(position_[axis] - clamped_[axis]));
    return weight == 1 ? inside : FieldType::mix(FieldType::border(scene_.store->border()), inside, weight);
  }

 private:
  float rounded_sample(const std::byte* block) const {
    std::array<int, 3> steps{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      steps[axis] = int(std::nearbyint(fraction_[axis] * float(filter_steps)));
    const auto texel = [&](int i) { return std::to_integer<int>(block[i]); };
    const auto along_x = [&](int i) { return rounded_mix(texel(i), texel(i + 1), steps[0]); };
    const auto along_y = [&](int i) {
      return rounded_mix(along_x(i), along_x(i + BrickStore::block_row), steps[1]);
    };
    return float(rounded_mix(along_y(corner_), along_y(corner_ + BrickStore::block_slice), steps[2]));
  }

  /// Finds the texels around the clamped position.
  void find_cell() {
    block_ = 0;
    corner_ = 0;
    std::size_t block_stride = 1;
    int texel_stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int cell = int(clamped_[axis]);
      fraction_[axis] = clamped_[axis] - float(cell);
      block_ += std::size_t(cell / BrickStore::block_cells - scene_.store->first_block()[axis]) * block_stride;
      corner_ += cell % BrickStore::block_cells * texel_stride;
      block_stride *= std::size_t(scene_.store->block_counts()[axis]);
      texel_stride *= BrickStore::block_row;
    }
  }

  const Scene& scene_;
  std::array<float, 3> position_{}, clamped_{}, fraction_{};
  std::size_t block_ = 0;  // index among the blocks held
  int corner_ = 0;         // lowest texel of the cell, in the block
};

}  // namespace understudy::volume
