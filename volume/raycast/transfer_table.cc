// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/transfer_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace understudy::volume {

TransferTable::TransferTable(const TransferFunction& function, TexelType type, float neutral) {
  const double unit = type == TexelType::f32 ? 1 : type == TexelType::u16 ? 65535 : 255;
  entries_ = function.entries.size();
  low_ = float(function.low * unit);
  const double scale = double(entries_ - 1) / ((double(function.high) - double(function.low)) * unit);
  scale_ = float(std::min(scale, double(std::numeric_limits<float>::max())));

  rows_.resize(8 * (entries_ + 1));
  for (std::size_t k = 0; k < 4; ++k) rows_[8 * entries_ + k] = neutral;
  showing_before_.resize(entries_ + 1);
  for (std::size_t i = 0; i < entries_; ++i) {
    const Rgba& entry = function.entries[i];
    const Rgba& next = function.entries[std::min(i + 1, entries_ - 1)];
    bool shows = false;
    for (std::size_t k = 0; k < 4; ++k) {
      rows_[8 * i + k] = entry[k];
      rows_[8 * i + 4 + k] = next[k] - entry[k];
      shows = shows || entry[k] != 0;
    }
    showing_before_[i + 1] = showing_before_[i] + (shows ? 1 : 0);
  }
}

bool TransferTable::shows(const BrickStore::Range& range) const {
  if (!(range.low <= range.high)) return false;
  const auto position = [&](float value) { return std::clamp((value - low_) * scale_, 0.0F, last()); };
  const auto from = std::size_t(std::floor(position(range.low)));
  const auto to = std::size_t(std::ceil(position(range.high)));
  return showing_before_[to + 1] != showing_before_[from];
}

}  // namespace understudy::volume
