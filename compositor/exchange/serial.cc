#include "compositor/exchange/serial.h"

#include <algorithm>
#include <vector>

#include "compositor/blend.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

Exchanged serial(volume::Image mine, const Composition& composition, Link& link) {
  Exchanged result;
  for (std::size_t rank = 1; rank < composition.footprints.size(); ++rank)
    result.bytes += 4 * sizeof(float) * composition.footprints[rank].pixels();
  if (link.rank() != 0) {
    if (mine.rect.empty()) return result;
    const Outgoing message{0, std::as_bytes(std::span(mine.rgba))};
    link.transfer({&message, 1}, {});
    return result;
  }

  std::vector<volume::Image> images(composition.footprints.size());
  std::vector<Incoming> incoming;
  volume::Rect whole;
  for (const Rank rank : composition.order) {
    const volume::Rect& footprint = composition.footprints[std::size_t(rank)];
    whole = bounding(whole, footprint);
    if (rank == 0 || footprint.empty()) continue;
    volume::Image& image = images[std::size_t(rank)] = volume::Image(footprint);
    incoming.push_back({rank, std::as_writable_bytes(std::span(image.rgba))});
  }
  link.transfer({}, incoming);
  images[0] = std::move(mine);

  result.picture = volume::Image(whole);
  std::ranges::fill(result.picture.rgba, volume::neutral_value(composition.op));
  for (const Rank rank : composition.order)
    blend(composition.op, result.picture, images[std::size_t(rank)].view());
  return result;
}

}  // namespace understudy::compositor
