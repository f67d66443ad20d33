// SPDX-License-Identifier: Apache-2.0
// Bricks of a volume of which only some are in textures at a time. Free of OpenGL, for command lines.
#pragma once

#include <cstdint>

namespace understudy::volume::glsl {

/// Cells along a brick's edge, a power of two. Faces that bricks share are in each of them, so a brick has one
/// texel more.
constexpr int usual_brick_cells = 64;

/// One brick of the widest texels (four channels of 16 bits): with less, some volumes cannot be drawn at all.
constexpr std::uint64_t least_texture_memory =
    std::uint64_t(usual_brick_cells + 1) * (usual_brick_cells + 1) * (usual_brick_cells + 1) * 8;

}  // namespace understudy::volume::glsl
