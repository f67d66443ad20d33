// SPDX-License-Identifier: Apache-2.0
// Integrals of pixels on their way from the ranks, each of which knows its own cells, to the application; and
// the messages they travel in.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/pixel_integral.h"
#include "volume/request.h"

namespace understudy::compositor {

/// What one rank's cells show of a pixel, by themselves. Opacity as optical depth: of fog no digit is lost.
struct IntegralPart {
  std::array<double, 3> colour{};
  double optical_depth = 0;
};

/// The pixels that all ranks came to: `parts` by rank, composed in `visibility_order`, front first.
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

// Both throw MalformedMessage. What comes back keeps within limits.h.
IntegralQuestion decode_integral_question(std::span<const std::byte> payload);
std::vector<volume::PixelIntegral> decode_integrals(std::span<const std::byte> payload);

}  // namespace understudy::compositor
