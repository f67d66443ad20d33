// SPDX-License-Identifier: Apache-2.0
// How the field between texels, and beyond the outermost, is made of the texels: as by OpenGL's samplers.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// Of GL_NEAREST and GL_LINEAR (OpenGL 4.6, section 8.14); no mip-mapping.
enum class Filter : std::uint8_t { nearest, linear };

/// What the linear filter reads beyond the outermost texels.
enum class Wrap : std::uint8_t { edge, border, repeat };

}  // namespace understudy::volume
