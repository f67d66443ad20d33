// Tables of pairs, observed: colours may depend on two samples, the front and the back of a slab.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "volume/classification.h"

namespace understudy::spu {

/// So many values on either side are looked at at once.
constexpr std::size_t pair_tile = 64;
using PairValues = std::array<float, pair_tile>;

/// What the fragment stage gives for all pairs of a front's and a back's value, the front's running faster.
using ColoursOfPairs =
    std::function<std::vector<volume::Rgba>(const PairValues& front, const PairValues& back)>;

/// The table over values in `range`, as coarse as shows no difference. Plain colours where `premultiplied` is
/// false.
volume::PairTable measure_pairs(const ColoursOfPairs& colours, const std::array<float, 2>& range,
                                bool premultiplied);

/// The least and the largest colour that the table has within `entries` entries of the pair at (front, back),
/// both as parts of the range.
std::array<volume::Rgba, 2> colours_around(const volume::PairTable& table, double front, double back,
                                           double entries);

}  // namespace understudy::spu
