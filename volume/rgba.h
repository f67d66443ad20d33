// SPDX-License-Identifier: Apache-2.0
// Red, green, blue and opacity. Whether colour is premultiplied is specified where the type is used.
#pragma once

#include <array>

namespace understudy::volume {

/// Red, green, blue, opacity; 1 is full intensity.
using Rgba = std::array<float, 4>;

}  // namespace understudy::volume
