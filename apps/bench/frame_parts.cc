// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/frame_parts.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "compositor/crop.h"
#include "volume/brick/brick_store.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/ray_setup.h"
#include "volume/request.h"

namespace understudy::bench {

using compositor::PixelMask;
using volume::BrickStore;
using volume::Rect;
using volume::TexelBox;

namespace {

Rect pixels_of(const volume::VolumeDescription& volume, const volume::RenderRequest& request,
               const TexelBox& cells) {
  return request.optimizations.footprints ? volume::footprint(request, volume, cells)
                                          : intersection(request.window, request.viewport);
}

RankPart cast_part(const volume::VolumeDescription& volume, std::span<const std::byte> texels,
                   const volume::RenderRequest& request, const TexelBox& cells) {
  BrickStore store(volume, cells);
  store.add_slices(volume.stored, texels);
  store.finish();
  RankPart part;
  part.cast = pixels_of(volume, request, cells);
  volume::Image image(part.cast);
  volume::FrameCounts counts;
  volume::raycast(store, request, image, counts);
  if (request.optimizations.footprints) compositor::crop_to_content(image, request.op);
  part.mask = compositor::mask_of(image.view(), request.op);
  part.samples = counts.samples_taken;
  return part;
}

/// Crops the mask to the smallest rectangle that contains all touched pixels.
PixelMask cropped(const PixelMask& mask) {
  Rect kept;
  const Rect& rect = mask.rect;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::uint8_t* const row = mask.at(rect.x, y);
    const std::uint8_t* const end = row + rect.width;
    const std::uint8_t* const first = std::find(row, end, 1);
    if (first == end) continue;
    const std::uint8_t* last = end - 1;
    while (*last == 0) --last;
    kept = bounding(kept, {rect.x + int(first - row), y, int(last - first) + 1, 1});
  }
  PixelMask result(kept);
  for (int y = kept.y; y < kept.y + kept.height; ++y)
    std::copy_n(mask.at(kept.x, y), kept.width, result.at(kept.x, y));
  return result;
}

RankPart part_of_rays(const volume::RaySetup& setup, const volume::RenderRequest& request, const Rect& rect) {
  RankPart part;
  part.cast = rect;
  PixelMask mask(rect);
  volume::RayPacket packet;
  const int right = rect.x + rect.width, top = rect.y + rect.height;
  for (int y = rect.y; y < top; y += volume::packet_height)
    for (int x = rect.x; x < right; x += volume::tile_width) {
      const int width = std::min(volume::tile_width, right - x),
                height = std::min(volume::packet_height, top - y);
      if (!set_up_packet(setup, request, x, y, width, height, packet)) continue;
      for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
          const auto ray = std::size_t(row) * volume::tile_width + std::size_t(column);
          const int samples = packet.last[ray] - packet.first[ray] + 1;
          if (samples <= 0) continue;
          part.samples += std::uint64_t(samples);
          *mask.at(x + column, y + row) = 1;
        }
    }
  part.mask = request.optimizations.footprints ? cropped(mask) : std::move(mask);
  return part;
}

}  // namespace

std::uint64_t FrameParts::samples() const {
  std::uint64_t sum = 0;
  for (const RankPart& part : ranks) sum += part.samples;
  return sum;
}

FrameParts cast_parts(const volume::VolumeDescription& volume, std::span<const std::byte> texels,
                      const volume::RenderRequest& request, const volume::KdTree& tree) {
  FrameParts parts{tree.visibility_order(request), {}};
  for (int rank = 0; rank < tree.ranks(); ++rank)
    parts.ranks.push_back(cast_part(volume, texels, request, tree.box(rank)));
  return parts;
}

FrameParts parts_of_rays(const volume::VolumeDescription& volume, const volume::RenderRequest& request,
                         const volume::KdTree& tree) {
  FrameParts parts{tree.visibility_order(request), {}};
  // Ray setup needs only the lattice, so the store stays empty.
  const TexelBox lattice = volume::cell_lattice(volume).box();
  const BrickStore store(volume, {lattice.low, lattice.low});
  parts.ranks.resize(std::size_t(tree.ranks()));
  tbb::parallel_for(0, tree.ranks(), [&](int rank) {
    const TexelBox& cells = tree.box(rank);
    parts.ranks[std::size_t(rank)] =
        part_of_rays(volume::RaySetup(request, store, cells), request, pixels_of(volume, request, cells));
  });
  return parts;
}

compositor::CountedExchange counted(const FrameParts& parts, compositor::Algorithm algorithm,
                                    compositor::Gather gather, volume::Operator op, compositor::Layout layout) {
  std::vector<Rect> footprints;
  std::vector<PixelMask> masks;
  for (const RankPart& part : parts.ranks) {
    footprints.push_back(part.mask.rect);
    masks.push_back(part.mask);
  }
  compositor::Schedule schedule = compositor::schedule(algorithm, parts.order, footprints);
  compositor::write_gathered(schedule,
                             std::vector<bool>(parts.ranks.size(), gather == compositor::Gather::direct));
  return compositor::counted_exchange(schedule, masks, op, layout);
}

}  // namespace understudy::bench
