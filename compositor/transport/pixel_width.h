// SPDX-License-Identifier: Apache-2.0
// How wide the numbers are in which the pixels of an image travel.
#pragma once

#include <cstdint>

namespace understudy::compositor {

/// What a value is rounded to, each time it travels: rgba32f not at all; rgba16f to 2^-11 of itself, at most
/// 65504; rgba8 to 1/510, in [0, 1].
enum class Layout : std::uint8_t { rgba32f, rgba16f, rgba8 };

}  // namespace understudy::compositor
