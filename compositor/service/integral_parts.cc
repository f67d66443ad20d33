// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/integral_parts.h"

#include <algorithm>
#include <cmath>

#include "compositor/service/limits.h"
#include "compositor/service/request_message.h"
#include "compositor/transport/wire.h"

namespace understudy::compositor {

std::vector<volume::PixelIntegral> composed_integrals(std::span<const std::vector<IntegralPart>> parts,
                                                      std::span<const int> visibility_order) {
  std::size_t known = parts.empty() ? 0 : parts[0].size();
  for (const std::vector<IntegralPart>& of_rank : parts) known = std::min(known, of_rank.size());
  std::vector<volume::PixelIntegral> whole(known);
  for (std::size_t pixel = 0; pixel < known; ++pixel) {
    double depth = 0;
    for (const int rank : visibility_order) {
      const IntegralPart& part = parts[std::size_t(rank)][pixel];
      const double light = std::exp(-depth);
      for (std::size_t k = 0; k < 3; ++k) whole[pixel][k] += light * part.colour[k];
      depth += part.optical_depth;
    }
    whole[pixel][3] = -std::expm1(-depth);
  }
  return whole;
}

std::vector<std::byte> encode(const volume::RenderRequest& request, std::span<const volume::Pixel> pixels,
                              double most_ms) {
  Writer out;
  out.run(encode(request));
  out.run(std::as_bytes(pixels));
  out.real(most_ms);
  return out.bytes();
}

IntegralQuestion decode_integral_question(std::span<const std::byte> payload) {
  Reader in("integrals", payload);
  IntegralQuestion question;
  question.request = decode_request(in.run("request", limits::max_message_bytes));
  question.pixels = in.values<volume::Pixel>("pixels", limits::max_integrals);
  constexpr int farthest = limits::max_viewport_offset + limits::max_viewport_extent;
  for (const volume::Pixel& pixel : question.pixels)
    for (const int place : {pixel.x, pixel.y})
      if (place < -farthest || place > farthest) in.fail("pixels", "lie outside of any window");
  question.most_ms = in.real("most_ms");
  if (!(question.most_ms >= 0 && question.most_ms <= limits::max_integral_ms))
    in.fail("most_ms", "is no time that a node may take");
  in.end();
  return question;
}

std::vector<std::byte> encode(std::span<const volume::PixelIntegral> integrals) {
  Writer out;
  out.run(std::as_bytes(integrals));
  return out.bytes();
}

std::vector<volume::PixelIntegral> decode_integrals(std::span<const std::byte> payload) {
  Reader in("integrals' reply", payload);
  auto integrals = in.values<volume::PixelIntegral>("integrals", limits::max_integrals);
  in.end();
  for (const volume::PixelIntegral& integral : integrals)
    for (const double value : integral)
      if (!std::isfinite(value)) in.fail("integrals", "are not finite");
  return integrals;
}

}  // namespace understudy::compositor
