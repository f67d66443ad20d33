// SPDX-License-Identifier: Apache-2.0
// Measures pre-integration tables: colours may depend on two samples, at the front and the back of a segment.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "volume/classification.h"

namespace understudy::spu {

/// This many front values are measured with as many back values at once.
constexpr std::size_t segment_tile = 64;
using SegmentValues = std::array<float, segment_tile>;

/// Returns the fragment stage's colours for all pairs of a front and a back value; the front value varies
/// faster.
using ColoursOfPairs =
    std::function<std::vector<volume::Rgba>(const SegmentValues& front, const SegmentValues& back)>;

/// Measures the table over values in `range`, as coarse as makes no difference. Its colours are not
/// premultiplied if `premultiplied` is false.
volume::PreIntegrationTable measure_segments(const ColoursOfPairs& colours, const std::array<float, 2>& range,
                                             bool premultiplied);

/// Returns the least and the greatest value of each channel in the table within `entries` entries of the pair
/// (front, back), both given as fractions of the range.
std::array<volume::Rgba, 2> colours_around(const volume::PreIntegrationTable& table, double front, double back,
                                           double entries);

}  // namespace understudy::spu
