// SPDX-License-Identifier: Apache-2.0
// What a pixel would show if its samples were taken ever more densely (volume/reference/pixel_integral.h).
#pragma once

#include <array>

namespace understudy::volume {

/// Premultiplied colour and opacity.
using PixelIntegral = std::array<double, 4>;

}  // namespace understudy::volume
