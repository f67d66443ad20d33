// SPDX-License-Identifier: Apache-2.0
// Converts images read from OpenGL to the layout of images in files.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "apps/understudy/images/image.h"
#include "spu/stream/decode.h"
#include "spu/window_system/window_system.h"

namespace understudy::launcher {

/// Converts an image as shown: `rgba` with 8 bits, rows bottom up; the result is opaque.
RgbaImage image_of(std::span<const std::uint8_t> rgba, spu::Extent2D extent);

/// Returns nothing for reads that are not images: depth, indices, or a few pixels as read for picking.
std::optional<RgbaImage> image_of(const spu::Decoder::ReadImage& read);

}  // namespace understudy::launcher
