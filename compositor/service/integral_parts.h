// SPDX-License-Identifier: Apache-2.0
// Composes integrals of whole rays from the parts of the ranks, each of which has only its own cells; and the
// messages for them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/pixel_integral.h"
#include "volume/request.h"

namespace understudy::compositor {

/// What one rank's cells alone show of a pixel. Opacity is optical depth, which keeps all digits of thin fog.
struct IntegralPart {
  std::array<double, 3> colour{};
  double optical_depth = 0;
};

/// Composes the pixels that all ranks have computed: `parts` by rank, in `visibility_order`, front first.
std::vector<volume::PixelIntegral> composed_integrals(std::span<const std::vector<IntegralPart>> parts,
                                                      std::span<const int> visibility_order);

struct IntegralQuestion {
  volume::RenderRequest request;
  std::vector<volume::Pixel> pixels;
  double most_ms = 0;
};

std::vector<std::byte> encode(const volume::RenderRequest& request, std::span<const volume::Pixel> pixels,
                              double most_ms);
std::vector<std::byte> encode(std::span<const volume::PixelIntegral> integrals);

// Both throw MalformedMessage. Decoded values are within limits.h.
IntegralQuestion decode_integral_question(std::span<const std::byte> payload);
std::vector<volume::PixelIntegral> decode_integrals(std::span<const std::byte> payload);

}  // namespace understudy::compositor
