// SPDX-License-Identifier: Apache-2.0
// Tables of 256 colours, not premultiplied.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace adversary {

using Colour = std::array<std::uint8_t, 4>;

/// Smooth colours of low opacity, so that all depths of a volume show.
std::vector<Colour> soft_colours();
/// Other colours than `soft_colours`, of as low an opacity.
std::vector<Colour> other_colours();
/// Smooth colours, all opaque: for maxima and minima.
std::vector<Colour> opaque_colours();
/// Four colours with sharp borders between them.
std::vector<Colour> step_colours();
std::vector<Colour> premultiplied(std::vector<Colour> colours);
std::vector<float> as_floats(const std::vector<Colour>& colours);

}  // namespace adversary
