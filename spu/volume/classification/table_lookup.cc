// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/table_lookup.h"

#include <algorithm>
#include <cstddef>

namespace understudy::spu {

volume::Rgba table_at(const volume::TransferFunction& table, float value) {
  const auto last = float(table.entries.size() - 1);
  const float place = std::clamp((value - table.low) / (table.high - table.low), 0.0F, 1.0F) * last;
  const auto below = std::size_t(place);
  const std::size_t above = std::min(below + 1, table.entries.size() - 1);
  const float s = place - float(below);
  volume::Rgba colour;
  for (std::size_t c = 0; c < 4; ++c)
    colour[c] = table.entries[below][c] + s * (table.entries[above][c] - table.entries[below][c]);
  return colour;
}

}  // namespace understudy::spu
