// SPDX-License-Identifier: Apache-2.0
#include "compositor/passes/pass_plan.h"

#include <algorithm>

#include "compositor/service/loads.h"
#include "volume/brick/brick_store.h"
#include "volume/description.h"
#include "volume/file/volume_file.h"

namespace understudy::compositor {

using volume::BrickStore;
using volume::TexelBox;
using volume::VolumeDescription;

namespace {

/// Bytes that a rank needs while it reads `box` by slice ranges: the scalars, the texels made from them, and
/// what the file itself needs.
std::uint64_t bytes_to_read(const VolumeDescription& volume, const volume::VolumeFile& file, TexelBox box) {
  const std::size_t scalar = volume::bytes_per_scalar(file.description().type);
  const std::size_t texel = volume::bytes_per_texel(volume.type);
  TexelBox slice = box;
  slice.high[2] = slice.low[2] + 1;
  const std::size_t slice_scalars = volume::texels_in(slice);
  const auto slices =
      int(std::max<std::size_t>(1, Loads::part_bytes / std::max<std::size_t>(1, slice_scalars * scalar)));
  box.high[2] = std::min(box.high[2], box.low[2] + slices);
  return volume::texels_in(box) * (scalar + texel) + file.memory_to_read(box);
}

}  // namespace

std::uint64_t bytes_of_rank(const VolumeDescription& volume, const volume::VolumeFile& file, int ranks) {
  std::uint64_t most = 0;
  for (const volume::Partition& partition :
       {volume::by_blocks(volume, ranks), volume::by_factors(volume, ranks)})
    for (const TexelBox& cells : volume::boxes(partition, volume)) {
      if (volume::is_empty(cells)) continue;
      most = std::max(most, BrickStore::most_bytes(volume, cells) +
                                bytes_to_read(volume, file, BrickStore::texels_shown(volume, cells)));
    }
  return most;
}

std::optional<volume::Partition> passes_within(const VolumeDescription& volume, const volume::VolumeFile& file,
                                               int ranks, std::uint64_t bytes) {
  for (int passes = 1; passes <= max_passes; passes += std::max(1, passes / 8)) {
    volume::Partition partition = volume::by_blocks(volume, passes);
    const std::vector<TexelBox> parts = volume::boxes(partition, volume);
    const bool fit = std::ranges::all_of(parts, [&](const TexelBox& part) {
      if (volume::is_empty(part)) return true;
      VolumeDescription shown = volume;
      shown.part = part;
      return bytes_of_rank(shown, file, ranks) <= bytes;
    });
    if (fit) return partition;
  }
  return std::nullopt;
}

}  // namespace understudy::compositor
