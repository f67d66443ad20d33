// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/sample_rounding.h"

#include <algorithm>
#include <cmath>

namespace understudy::spu {
namespace {

constexpr double steps = 255;

volume::Rgba entry_at(const volume::TransferFunction& table, double value) {
  const auto last = double(table.entries.size() - 1);
  const double place = std::clamp((value - table.low) / (double(table.high) - table.low), 0.0, 1.0) * last;
  const auto below = std::size_t(place);
  const std::size_t above = std::min(below + 1, table.entries.size() - 1);
  const auto share = float(place - double(below));
  volume::Rgba colour;
  for (std::size_t c = 0; c < 4; ++c)
    colour[c] = table.entries[below][c] + share * (table.entries[above][c] - table.entries[below][c]);
  return colour;
}

}  // namespace

volume::TransferFunction with_rounded_samples(const volume::TransferFunction& table) {
  constexpr int entries_a_step = 16;  // a flank of the staircase is as wide as one entry
  const double extent = double(table.high) - table.low;
  const auto entries = std::size_t(std::ceil(extent * steps)) * entries_a_step + 1;
  volume::TransferFunction rounded{table.low, table.high, {}};
  rounded.entries.reserve(entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const double value = table.low + extent * double(i) / double(entries - 1);
    rounded.entries.push_back(entry_at(table, std::round(value * steps) / steps));
  }
  return rounded;
}

void round_samples(volume::Classification& colours) {
  if (auto* const table = std::get_if<volume::TransferFunction>(&colours))
    *table = with_rounded_samples(*table);
}

bool SampleRounding::try_after_loss(const TextureDescription& texture) {
  if (state_ == State::tried) state_ = State::refuted;
  if (state_ != State::exact) return false;
  if (texture.type != volume::TexelType::u8 || texture.filter != volume::Filter::linear) return false;
  state_ = State::tried;
  return true;
}

}  // namespace understudy::spu
