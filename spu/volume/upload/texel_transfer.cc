// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/upload/texel_transfer.h"

#include <algorithm>
#include <vector>

#include "compositor/service.h"
#include "volume/cell_lattice.h"

namespace understudy::spu {
namespace {

using volume::TexelBox;

/// Bytes that are read and sent together, unless one layer of blocks is larger.
constexpr std::size_t slice_range_bytes = std::size_t(4) << 20;

std::uint64_t bytes_of(const TexelBox& box, const volume::VolumeDescription& volume) {
  return volume::texels_in(box) * volume::bytes_per_texel(volume.type);
}

/// Reads `box` in slice ranges of a multiple of `unit` slices.
template <class Use>
void read_slice_ranges(const volume::VolumeDescription& volume, const TexelBox& box, int unit,
                       TexelSource& source, Use use) {
  TexelBox slice_range = box;
  slice_range.high[2] = std::min(box.low[2] + unit, box.high[2]);
  const std::uint64_t one = std::max<std::uint64_t>(1, bytes_of(slice_range, volume));
  const int slices = unit * int(std::clamp<std::uint64_t>(slice_range_bytes / one, 1, volume::max_axis_texels));
  std::vector<std::byte> texels;
  for (slice_range.low[2] = box.low[2]; slice_range.low[2] < box.high[2];
       slice_range.low[2] = slice_range.high[2]) {
    slice_range.high[2] = std::min(slice_range.low[2] + slices, box.high[2]);
    texels.resize(bytes_of(slice_range, volume));
    source.read(slice_range, texels);
    use(slice_range, texels);
  }
}

}  // namespace

Transferred send_volume(compositor::RenderService& service, const volume::VolumeDescription& volume,
                        TexelSource& source, BlockHashes& hashes) {
  service.begin_volume(volume);
  read_slice_ranges(volume, volume.stored, 1, source,
                    [&](const TexelBox& slice_range, std::span<const std::byte> texels) {
                      service.add_texels(volume.id, {&slice_range, 1}, texels);
                      hashes.take(slice_range, texels);
                    });
  service.end_volume(volume.id);
  return {bytes_of(volume.stored, volume), 0};
}

Transferred send_changes(compositor::RenderService& service, volume::VolumeDescription& volume,
                         std::span<const TexelBox> regions, TexelSource& source, BlockHashes& hashes) {
  Transferred transferred;
  bool begun = false;
  std::vector<std::byte> packed;
  for (const TexelBox& region : regions) {
    const TexelBox blocks = hashes.whole_blocks(region);
    if (volume::is_empty(blocks)) continue;
    read_slice_ranges(volume, blocks, BlockHashes::edge, source,
                      [&](const TexelBox& slice_range, std::span<const std::byte> texels) {
                        const std::vector<TexelBox> changed = hashes.take(slice_range, texels);
                        if (changed.empty()) return;
                        if (!begun) service.begin_change(volume.id, ++volume.version);
                        begun = true;
                        packed.clear();
                        for (const TexelBox& box : changed) {
                          const std::size_t at = packed.size();
                          packed.resize(at + bytes_of(box, volume));
                          volume::copy_texels(box, volume::bytes_per_texel(volume.type), slice_range, texels,
                                              box, std::span(packed).subspan(at));
                        }
                        service.add_texels(volume.id, changed, packed);
                        transferred.sent += packed.size();
                      });
  }
  if (begun) service.end_volume(volume.id);
  // Regions may overlap: texels that changed in between are sent twice.
  const std::uint64_t whole = bytes_of(volume.stored, volume);
  transferred.left_out = whole - std::min(whole, transferred.sent);
  return transferred;
}

}  // namespace understudy::spu
