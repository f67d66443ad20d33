// SPDX-License-Identifier: Apache-2.0
// Pre-integration tables, observed: colours may depend on two samples, the front and the back of a segment.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "volume/classification.h"

namespace understudy::spu {

/// So many values on either side are looked at at once.
constexpr std::size_t segment_tile = 64;
using SegmentValues = std::array<float, segment_tile>;

/// What the fragment stage gives for all pairs of a front's and a back's value, the front's running faster.
using ColoursOfPairs =
    std::function<std::vector<volume::Rgba>(const SegmentValues& front, const SegmentValues& back)>;

/// The table over values in `range`, as coarse as shows no difference. Plain colours where `premultiplied` is
/// false.
volume::PreIntegrationTable measure_segments(const ColoursOfPairs& colours, const std::array<float, 2>& range,
                                             bool premultiplied);

/// The least and the largest colour that the table has within `entries` entries of the pair at (front, back),
/// both as parts of the range.
std::array<volume::Rgba, 2> colours_around(const volume::PreIntegrationTable& table, double front, double back,
                                           double entries);

}  // namespace understudy::spu
