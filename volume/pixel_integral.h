// SPDX-License-Identifier: Apache-2.0
// The limit of a pixel for ever denser samples (volume/reference/pixel_integral.h).
#pragma once

#include <array>

namespace understudy::volume {

/// Premultiplied colour and opacity.
using PixelIntegral = std::array<double, 4>;

}  // namespace understudy::volume
