// SPDX-License-Identifier: Apache-2.0
// Images as OpenGL has them, made to lie as images in files do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "apps/understudy/images/image.h"
#include "spu/stream/decode.h"
#include "spu/window_system/window_system.h"

namespace understudy::launcher {

/// `rgba` with 8 bits, rows bottom up, as it is shown: opaque.
RgbaImage image_of(std::span<const std::uint8_t> rgba, spu::Extent2D extent);

/// Nothing for what is no image: depth, indices, a few pixels as read for picking.
std::optional<RgbaImage> image_of(const spu::Decoder::ReadImage& read);

}  // namespace understudy::launcher
