// SPDX-License-Identifier: Apache-2.0
// Sizes of bricks, for volumes that are only partly in textures. Independent of OpenGL, for command lines.
#pragma once

#include <cstdint>

namespace understudy::volume::glsl {

/// Cells along a brick's edge, a power of two. Neighbouring bricks both store the face that they share, so a
/// brick has one texel more along each axis.
constexpr int usual_brick_cells = 64;

/// One brick of the widest texels (four channels of 16 bits), required to draw any volume.
constexpr std::uint64_t least_texture_memory =
    std::uint64_t(usual_brick_cells + 1) * (usual_brick_cells + 1) * (usual_brick_cells + 1) * 8;

}  // namespace understudy::volume::glsl
