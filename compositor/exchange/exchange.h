// What all exchanges share: the images of the ranks go in, one picture comes out on rank 0.
#pragma once

#include <cstdint>
#include <span>

#include "compositor/exchange/link.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

/// What every rank knows before an exchange begins.
struct Composition {
  volume::Operator op = volume::Operator::over;
  /// All ranks, front first: the image of an earlier rank covers that of a later one.
  std::span<const Rank> order;
  /// The rectangle of every rank's image, by rank; empty for a rank with nothing to show.
  std::span<const volume::Rect> footprints;
};

struct Exchanged {
  volume::Image picture;  ///< on rank 0: over the smallest rectangle that holds all footprints; else empty
  std::uint64_t bytes =
      0;  ///< of pixels that travelled between all ranks; every rank can tell from the footprints
};

}  // namespace understudy::compositor
