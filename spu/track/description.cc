// SPDX-License-Identifier: Apache-2.0
#include "spu/track/description.h"

#include "spu/track/track.h"

namespace understudy::spu {

namespace {

constexpr UnitOption track_options[] = {
    {.name = "answer",
     .type = OptionType::on_off,
     .fallback = "off",
     .help = "answer glGet from tracked state, until a call may have changed the value"}};

}  // namespace

constinit const UnitDescription track_description{
    .name = "track",
    .help = "tracks state that OpenGL cannot be queried for later, and detects the first 3-D texture",
    .options = track_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Track>(place.chain, place.options.is_on("answer"));
    }};

}  // namespace understudy::spu
