// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/description.h"

#include "spu/volume/volume_unit.h"

namespace understudy::spu {

constinit const UnitDescription volume_description{
    .name = "volume",
    .help = "recognises where a program draws a volume, and draws it by ray casting instead",
    .needs = "track",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<VolumeUnit>(place.chain, place.session);
    }};

}  // namespace understudy::spu
