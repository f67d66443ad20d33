#include "spu/track/description.h"

#include "spu/track/track.h"

namespace understudy::spu {

constinit const UnitDescription track_description{
    .name = "track",
    .help = "remembers what OpenGL cannot be asked for later, and notices the first 3-D texture",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Track>(place.chain);
    }};

}  // namespace understudy::spu
