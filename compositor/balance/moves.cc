// SPDX-License-Identifier: Apache-2.0
#include "compositor/balance/moves.h"

#include <algorithm>

#include "compositor/balance/block_edge.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"

namespace understudy::compositor {

using volume::TexelBox;

TexelBox blocks_kept(const volume::VolumeDescription& volume, const TexelBox& cells) {
  if (volume::is_empty(cells)) return {};
  const TexelBox lattice = volume::cell_lattice(volume).box();
  TexelBox blocks;
  for (std::size_t k = 0; k < 3; ++k) {
    const int low = std::max(cells.low[k] - volume.ghost_layer, lattice.low[k]) - lattice.low[k];
    const int high = std::min(cells.high[k] + volume.ghost_layer, lattice.high[k]) - lattice.low[k];
    blocks.low[k] = low / block_edge;
    blocks.high[k] = (high + block_edge - 1) / block_edge;
  }
  return blocks;
}

TexelBox blocks_owned(const TexelBox& lattice, const TexelBox& cells) {
  if (volume::is_empty(cells)) return {};
  TexelBox blocks;
  for (std::size_t k = 0; k < 3; ++k) {
    blocks.low[k] = (cells.low[k] - lattice.low[k] + block_edge - 1) / block_edge;
    blocks.high[k] = (cells.high[k] - lattice.low[k] + block_edge - 1) / block_edge;
  }
  return blocks;
}

std::vector<TexelBox> difference(const TexelBox& a, const TexelBox& b) {
  if (volume::is_empty(a)) return {};
  const TexelBox common = volume::intersection(a, b);
  if (volume::is_empty(common)) return {a};
  std::vector<TexelBox> parts;
  TexelBox rest = a;
  for (std::size_t k = 0; k < 3; ++k) {
    TexelBox part = rest;
    part.high[k] = common.low[k];
    if (!volume::is_empty(part)) parts.push_back(part);
    part = rest;
    part.low[k] = common.high[k];
    if (!volume::is_empty(part)) parts.push_back(part);
    rest.low[k] = common.low[k];
    rest.high[k] = common.high[k];
  }
  return parts;
}

std::vector<BlockMove> moves(const volume::VolumeDescription& volume, std::span<const TexelBox> before,
                             std::span<const TexelBox> after) {
  const TexelBox lattice = volume::cell_lattice(volume).box();
  std::vector<BlockMove> result;
  for (std::size_t to = 0; to < after.size(); ++to) {
    const std::vector<TexelBox> missing =
        difference(blocks_kept(volume, after[to]), blocks_kept(volume, before[to]));
    for (std::size_t from = 0; !missing.empty() && from < before.size(); ++from) {
      const TexelBox owned = blocks_owned(lattice, before[from]);
      for (const TexelBox& part : missing)
        if (const TexelBox found = volume::intersection(part, owned); !volume::is_empty(found))
          result.push_back({int(from), int(to), found});
    }
  }
  return result;
}

std::size_t most_blocks_moved(const TexelBox& lattice, std::span<const TexelBox> before,
                              std::span<const TexelBox> after) {
  std::size_t most = 0;
  for (std::size_t rank = 0; rank < before.size(); ++rank) {
    const TexelBox had = blocks_owned(lattice, before[rank]), has = blocks_owned(lattice, after[rank]);
    const std::size_t stay = volume::texels_in(volume::intersection(had, has));
    most = std::max({most, volume::texels_in(had) - stay, volume::texels_in(has) - stay});
  }
  return most;
}

}  // namespace understudy::compositor
