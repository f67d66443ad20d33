// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/step_division.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace understudy::volume {

namespace {

/// Number of pieces: a multiple of the pieces of `function`, at least `least`.
std::size_t pieces_of(const TransferFunction& function, std::size_t least) {
  const std::size_t given = function.entries.size() - 1;
  return given * ((std::max(least, given) + given - 1) / given);
}

/// Prefix sums of the second differences (bends) and first differences (changes) of a function's entries.
class Roughness {
 public:
  explicit Roughness(const TransferFunction& function) {
    const std::size_t given = function.entries.size() - 1, pieces = pieces_of(function, StepDivision::bins - 1);
    std::vector<std::array<double, 4>> entries;
    for (std::size_t i = 0; i <= pieces; ++i)
      entries.push_back(entry_at(function, double(i) * double(given) / double(pieces)));
    for (std::size_t i = 0; i <= pieces; ++i) {
      const auto &before = entries[i - std::min<std::size_t>(i, 1)], &at = entries[i],
                 &behind = entries[std::min(i + 1, pieces)];
      double bend = 0, change = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        bend = std::max(bend, std::abs(before[k] - 2 * at[k] + behind[k]));
        change = std::max(change, std::abs(behind[k] - at[k]));
      }
      bends_.push_back(bends_.back() + bend);
      changes_.push_back(changes_.back() + change);
    }
  }

  double last() const { return double(bends_.size() - 2); }

  /// Estimates the error of one sample for a step of `cells` cells on which the value changes by `change`
  /// entries, between the positions `low` and `high`.
  double error(double low, double high, double change, double cells) const {
    const auto first = std::size_t(std::floor(std::clamp(low, 0.0, last()))),
               beyond = std::size_t(std::ceil(std::clamp(high, 0.0, last()))) + 1;
    return (bends_[beyond] - bends_[first]) * change / 8 + (changes_[beyond] - changes_[first]) * cells / 24;
  }

 private:
  std::vector<double> bends_{0}, changes_{0};  // of all entries before
};

/// The largest difference between neighbouring texels.
template <typename Texel>
float steepest(const std::byte* block) {
  std::array<Texel, BrickStore::block_texels> texels;
  std::memcpy(texels.data(), block, sizeof texels);
  float most = 0;
  constexpr std::array<std::size_t, 3> strides{1, BrickStore::block_row, BrickStore::block_slice};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < texels.size(); ++i) {
      if (i / strides[axis] % BrickStore::block_row == BrickStore::block_row - 1) continue;
      const float change = std::abs(float(texels[i + strides[axis]]) - float(texels[i]));
      if (change > most) most = change;  // false for NaN
    }
  return most;
}

float steepest(const BrickStore& store, std::size_t block) {
  const BrickStore::Range& range = store.ranges(block).front();
  if (!(range.low < range.high)) return 0;
  const std::byte* const texels = store.block_data()[block];
  switch (store.description().type) {
    case TexelType::u8:
      return steepest<std::uint8_t>(texels);
    case TexelType::u16:
      return steepest<std::uint16_t>(texels);
    case TexelType::f32:
      return steepest<float>(texels);
    case TexelType::rgba8:  // refused by validate()
      break;
  }
  return 0;
}

/// Upper bound of the change of the value over a step of class c >= 1, in entries.
double change_of_class(int c) {
  return std::exp2(0.5 * (c - 1) - 8);
}
constexpr int classes_at_all = 48;

}  // namespace

PartTable::PartTable(const TransferFunction& function, TexelType type) {
  constexpr std::size_t least_pieces = 4095;
  const std::size_t given = function.entries.size() - 1, pieces = pieces_of(function, least_pieces);
  entries_ = pieces + 1;
  low_ = float(double(function.low) * largest_texel(type));
  const double scale = double(pieces) / ((double(function.high) - double(function.low)) * largest_texel(type));
  scale_ = float(std::min(scale, double(std::numeric_limits<float>::max())));
  rows_.resize(8 * (neutral_entry() + 1));
  for (int divisions = 0; divisions <= most_divisions; ++divisions) {
    float* const rows = rows_.data() + 8 * std::size_t(divisions) * entries_;
    const double part = std::ldexp(1.0, -divisions);
    for (std::size_t i = 0; i < entries_; ++i) {
      const std::array<double, 4> entry = entry_at(function, double(i) * double(given) / double(pieces));
      const double alpha = entry[3];
      const double seen = divisions == 0 ? alpha : -std::expm1(part * std::log1p(-std::min(alpha, 1.0)));
      const double share = divisions == 0 ? 1 : alpha > 0 ? seen / alpha : part;
      for (std::size_t k = 0; k < 3; ++k) rows[8 * i + k] = float(share * entry[k]);
      rows[8 * i + 3] = float(seen);
    }
    for (std::size_t i = 0; i + 1 < entries_; ++i)
      for (std::size_t k = 0; k < 4; ++k) rows[8 * i + 4 + k] = rows[8 * (i + 1) + k] - rows[8 * i + k];
  }
}

StepDivision::StepDivision(const BrickStore& store, const TransferFunction& function, double tolerance,
                           double cells)
    : classes_(store.blocks() + 3), divisions_(std::size_t(classes_at_all) * bins + 3) {
  const Roughness roughness(function);
  const double unit = largest_texel(store.description().type);
  const double low = double(function.low) * unit;
  const double scale = roughness.last() / ((double(function.high) - double(function.low)) * unit);
  tbb::parallel_for(std::size_t(0), store.blocks(), [&](std::size_t b) {
    const BrickStore::Range& range = store.ranges(b).front();
    const double change =
        std::min(double(steepest(store, b)) * cells, double(range.high) - double(range.low)) * scale;
    if (!(change > 0)) return;
    const auto place = [&](float value) { return (double(value) - low) * scale; };
    if (roughness.error(place(range.low), place(range.high), change, cells) <= tolerance) return;
    const double wanted = std::ceil(2 * (std::log2(change) + 8)) + 1;
    classes_[b] = std::uint8_t(std::clamp(wanted, 1.0, classes_at_all - 1.0));
  });
  const double entries = roughness.last() / (bins - 1);  // per bin
  for (int c = 1; c < classes_at_all; ++c)
    for (int bin = 0; bin < bins; ++bin) {
      const double change = change_of_class(c);
      double error =
          roughness.error(bin * entries - change / 2, (bin + 1) * entries + change / 2, change, cells);
      std::uint8_t& divisions = divisions_[std::size_t(c) * bins + std::size_t(bin)];
      for (; error > tolerance && divisions < most_divisions; error /= 4) ++divisions;
    }
}

}  // namespace understudy::volume
