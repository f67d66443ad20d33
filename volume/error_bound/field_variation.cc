// SPDX-License-Identifier: Apache-2.0
#include "volume/error_bound/field_variation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace understudy::volume {
namespace {

using LatticePoint = std::array<int, 3>;

/// The store's texels by lattice point; outside the held points, the nearest one.
class HeldTexels {
 public:
  explicit HeldTexels(const BrickStore& store) : store_(store) {
    constexpr int block = BrickStore::block_cells;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = store.first_block()[axis] * block;
      high_[axis] = std::min(low_[axis] + store.block_counts()[axis] * block, store.lattice().cells[axis]);
    }
  }

  const LatticePoint& low() const { return low_; }
  /// The last lattice point held.
  const LatticePoint& high() const { return high_; }

  float at(LatticePoint p) const {
    constexpr int block = BrickStore::block_cells;
    std::size_t index = 0, stride = 1;
    int texel = 0, texel_stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int from_low = std::clamp(p[axis], low_[axis], high_[axis]) - low_[axis];
      const int of_block = std::min(from_low / block, store_.block_counts()[axis] - 1);
      index += std::size_t(of_block) * stride;
      texel += (from_low - of_block * block) * texel_stride;
      stride *= std::size_t(store_.block_counts()[axis]);
      texel_stride *= BrickStore::block_row;
    }
    const std::byte* const texels = store_.block_data()[index];
    switch (store_.description().type) {
      case TexelType::u8:
        return float(std::to_integer<int>(texels[texel]));
      case TexelType::u16:
        return read<std::uint16_t>(texels, texel);
      case TexelType::f32:
        return read<float>(texels, texel);
      case TexelType::rgba8:
        break;
    }
    return std::numeric_limits<float>::quiet_NaN();
  }

 private:
  template <typename Texel>
  static float read(const std::byte* texels, int index) {
    Texel texel;
    std::memcpy(&texel, texels + std::size_t(index) * sizeof texel, sizeof texel);
    return float(texel);
  }

  const BrickStore& store_;
  LatticePoint low_{}, high_{};
};

/// The texels of the cells of a row of cubes.
class RowOfTexels {
 public:
  /// Begins at lattice point `low` and covers `cells` cells along x.
  RowOfTexels(const HeldTexels& texels, const LatticePoint& low, int cells) : low_(low), width_(cells + 1) {
    values_.reserve(std::size_t(width_) * rows * rows);
    for (int z = 0; z < rows; ++z)
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < width_; ++x) values_.push_back(texels.at({low_[0] + x, low_[1] + y, low_[2] + z}));
  }

  float at(const LatticePoint& p) const {
    return values_[std::size_t(((p[2] - low_[2]) * rows + p[1] - low_[1]) * width_ + p[0] - low_[0])];
  }

 private:
  static constexpr int rows = FieldVariation::cube_cells + 1;

  LatticePoint low_;
  int width_;
  std::vector<float> values_;
};

/// Raises `most` to |value|; to infinity if `value` is NaN.
void raise(float& most, float value) {
  most = std::isnan(value) ? std::numeric_limits<float>::infinity() : std::max(most, std::abs(value));
}

LatticePoint moved(LatticePoint p, std::size_t axis, int by) {
  p[axis] += by;
  return p;
}

/// Raises the bounds by those of one cell, whose low corner is `p`.
void raise_by_cell(const RowOfTexels& texels, const LatticePoint& p, Variation& variation) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (const int i : {0, 1})
      for (const int j : {0, 1}) {
        const LatticePoint edge = moved(moved(p, a, i), b, j);
        raise(variation.slope[axis], texels.at(moved(edge, axis, 1)) - texels.at(edge));
      }
    // On the faces across the axis: the mixed derivative of the other two.
    for (const int side : {0, 1}) {
      const LatticePoint face = moved(p, axis, side);
      raise(variation.twist, (texels.at(moved(moved(face, a, 1), b, 1)) - texels.at(moved(face, a, 1))) -
                                 (texels.at(moved(face, b, 1)) - texels.at(face)));
    }
  }
}

}  // namespace

FieldVariation::FieldVariation(const BrickStore& store) {
  if (store.empty()) return;
  const HeldTexels texels(store);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_[axis] = texels.low()[axis] / cube_cells;
    const int cells = std::max(texels.high()[axis] - texels.low()[axis], 1);
    counts_[axis] = (cells + cube_cells - 1) / cube_cells;
  }
  cubes_.resize(std::size_t(counts_[0]) * std::size_t(counts_[1]) * std::size_t(counts_[2]));
  tbb::parallel_for(0, counts_[2], [&](int z) {
    std::size_t index = std::size_t(z) * std::size_t(counts_[1]) * std::size_t(counts_[0]);
    for (int y = 0; y < counts_[1]; ++y) {
      const LatticePoint begin{first_[0] * cube_cells, (first_[1] + y) * cube_cells,
                               (first_[2] + z) * cube_cells};
      const RowOfTexels row(texels, begin, counts_[0] * cube_cells);
      for (int x = 0; x < counts_[0]; ++x, ++index) {
        const LatticePoint low = moved(begin, 0, x * cube_cells);
        for (int k = 0; k < cube_cells; ++k)
          for (int j = 0; j < cube_cells; ++j)
            for (int i = 0; i < cube_cells; ++i)
              raise_by_cell(row, {low[0] + i, low[1] + j, low[2] + k}, cubes_[index]);
      }
    }
  });
}

int FieldVariation::cube_of(std::size_t axis, double position) const {
  const double clamped = std::clamp(position, -1e6, 1e9) / cube_cells;
  return std::clamp(int(std::floor(clamped)) - first_[axis], 0, counts_[axis] - 1);
}

const Variation& FieldVariation::cube(int x, int y, int z) const {
  const std::size_t row = std::size_t(z) * std::size_t(counts_[1]) + std::size_t(y);
  return cubes_[row * std::size_t(counts_[0]) + std::size_t(x)];
}

const Variation& FieldVariation::at(const std::array<double, 3>& position) const {
  return cube(cube_of(0, position[0]), cube_of(1, position[1]), cube_of(2, position[2]));
}

Variation FieldVariation::between(const std::array<double, 3>& a, const std::array<double, 3>& b) const {
  std::array<int, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = cube_of(axis, std::min(a[axis], b[axis]));
    high[axis] = cube_of(axis, std::max(a[axis], b[axis]));
  }
  Variation all;
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const Variation& one = cube(x, y, z);
        for (std::size_t axis = 0; axis < 3; ++axis)
          all.slope[axis] = std::max(all.slope[axis], one.slope[axis]);
        all.twist = std::max(all.twist, one.twist);
      }
  return all;
}

}  // namespace understudy::volume
