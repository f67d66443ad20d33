// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/sample_rounding.h"

#include <cmath>
#include <cstddef>

#include "spu/volume/classification/table_lookup.h"

namespace understudy::spu {
namespace {

constexpr double steps = 255;

}  // namespace

volume::TransferFunction with_rounded_samples(const volume::TransferFunction& table) {
  constexpr int entries_a_step = 16;  // a flank of the staircase is as wide as one entry
  const double extent = double(table.high) - table.low;
  const auto entries = std::size_t(std::ceil(extent * steps)) * entries_a_step + 1;
  volume::TransferFunction rounded{table.low, table.high, {}};
  rounded.entries.reserve(entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const double value = table.low + extent * double(i) / double(entries - 1);
    rounded.entries.push_back(table_at(table, float(std::round(value * steps) / steps)));
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
