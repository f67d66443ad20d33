// SPDX-License-Identifier: Apache-2.0
// The width of the numbers in which pixels of an image are sent.
#pragma once

#include <cstdint>

namespace understudy::compositor {

/// How a value is rounded each time it is sent: rgba32f not at all; rgba16f to 2^-11 of itself, at most 65504;
/// rgba8 to 1/510, in [0, 1].
enum class Layout : std::uint8_t { rgba32f, rgba16f, rgba8 };

}  // namespace understudy::compositor
