// Pictures as OpenGL has them, made to lie as pictures in files do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "apps/understudy/picture.h"
#include "spu/player/window_system.h"
#include "spu/stream/decode.h"

namespace understudy::launcher {

/// `rgba` with 8 bits, rows bottom up, as it is shown: opaque.
Picture picture_of(std::span<const std::uint8_t> rgba, spu::Extent2D extent);

/// Nothing for what is no picture: depth, indices, a few pixels as read for picking.
std::optional<Picture> picture_of(const spu::Decoder::ReadPicture& read);

}  // namespace understudy::launcher
