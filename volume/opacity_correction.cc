// SPDX-License-Identifier: Apache-2.0
#include "volume/opacity_correction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace understudy::volume {

TransferFunction opacity_corrected(const TransferFunction& function, double step, std::size_t most_entries) {
  if (step == 1) return function;
  const std::size_t pieces = function.entries.size() - 1;
  const std::size_t parts = std::max<std::size_t>(1, (most_entries - 1) / pieces);
  TransferFunction corrected{function.low, function.high, {}};
  corrected.entries.reserve(pieces * parts + 1);
  for (std::size_t i = 0; i <= pieces * parts; ++i) {
    const std::array<double, 4> entry = entry_at(function, double(i) / double(parts));
    const double alpha = std::min(entry[3], 1.0);
    const double seen = alpha < 1 ? -std::expm1(step * std::log1p(-alpha)) : 1;
    const double scale = alpha > 0 ? seen / alpha : step;
    corrected.entries.push_back(
        {float(entry[0] * scale), float(entry[1] * scale), float(entry[2] * scale), float(seen)});
  }
  return corrected;
}

}  // namespace understudy::volume
