// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/fog_table.h"

#include <algorithm>

namespace understudy::volume {

FogTable::FogTable(const Fog& fog, const BrickStore& store) {
  const std::size_t entries = fog.entries.size();
  last_ = entries - 1;
  const double scale = double(last_);
  double offset = fog.offset * scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double per_texel = fog.normal[axis] * scale / store.description().size[axis];
    gradient_[axis] = float(per_texel);
    offset += per_texel * (0.5 + store.lattice().origin[axis]);
  }
  offset_ = float(offset);

  rows_.resize(8 * entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const Rgba& next = fog.entries[std::min(i + 1, last_)];
    for (std::size_t k = 0; k < 4; ++k) {
      rows_[8 * i + k] = fog.entries[i][k];
      rows_[8 * i + 4 + k] = next[k] - fog.entries[i][k];
    }
  }
}

}  // namespace understudy::volume
