// SPDX-License-Identifier: Apache-2.0
// Measured fog. Colours may depend on one more scalar than the sample, such as the distance from the eye, if
// they do so in the same way for all samples: every colour is multiplied by a weight, and one colour is added.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "volume/classification.h"

namespace understudy::spu {

/// The scalar is one component of one input of the fragment stage.
struct MeasuredFog {
  std::size_t input = 0;
  std::size_t component = 0;
  float low = 0;  ///< the entries cover its values from `low` to `high`, at equal distances
  float high = 0;
  std::vector<volume::Rgba> entries;  ///< as in volume::Fog
  float reference = 0;                ///< value at which the weight is one: the table was drawn there
};

/// Returns the colours that the fragment stage gives for entry `entry` of the table, at values of the scalar
/// that rise in equal steps from the first to the last.
using ColoursAlongNumber = std::function<std::vector<volume::Rgba>(std::size_t entry)>;

/// Measures fog. `table` holds the colours of the entries at any one value of the scalar; their opacity decides
/// which entries count. `number` holds the values at which ColoursAlongNumber draws: those in `needed` must be
/// covered, others are if possible. `premultiplied`: colours include opacity. Null if colours are not those of
/// fog, or if opacity depends on the scalar.
std::optional<MeasuredFog> measure_fog(const std::vector<volume::Rgba>& table, bool premultiplied,
                                       const std::vector<float>& number, const std::array<float, 2>& needed,
                                       const ColoursAlongNumber& colours);

}  // namespace understudy::spu
