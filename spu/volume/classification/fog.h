// SPDX-License-Identifier: Apache-2.0
// Fog, observed: colours may depend on one more number than the sample, such as the distance from the eye, when
// they do so in the same way for all samples: every colour is faded by a weight, and one colour is added.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "volume/classification.h"

namespace understudy::spu {

/// The number is one component of one input of the fragment stage.
struct MeasuredFog {
  std::size_t input = 0;
  std::size_t component = 0;
  float low = 0;  ///< its values that the entries cover, at equal distances
  float high = 0;
  std::vector<volume::Rgba> entries;  ///< as in volume::Fog
  float reference = 0;                ///< where the weight is one: the table was drawn there
};

/// What the fragment stage gives for entry `entry` of the table, at values of the number that rise in equal
/// steps from the first to the last.
using ColoursAlongNumber = std::function<std::vector<volume::Rgba>(std::size_t entry)>;

/// `table` holds the colours of the entries at any one value of the number, and tells by their opacity which
/// entries count. `number` are the values behind ColoursAlongNumber, of which those in `needed` must be covered
/// and others are where possible. `premultiplied`: colours hold opacity already. Null when the colours are no
/// fog, or opacity depends on the number.
std::optional<MeasuredFog> measure_fog(const std::vector<volume::Rgba>& table, bool premultiplied,
                                       const std::vector<float>& number, const std::array<float, 2>& needed,
                                       const ColoursAlongNumber& colours);

}  // namespace understudy::spu
