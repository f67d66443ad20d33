// SPDX-License-Identifier: Apache-2.0
// Sort-first: cuts an image by a kd-tree into leaves of equal cost. The cuts are found by binary search in the
// summed-area table of the costs. (Moloney, Weiskopf, Moeller, Strengert 2007, section 4.)
#pragma once

#include <vector>

#include "compositor/sort/cost_image.h"
#include "volume/rect.h"

namespace understudy::compositor {

/// Cuts lie at multiples of this many pixels, because rays are cast four by four.
constexpr int leaf_alignment = 4;

/// Returns `count` >= 1 rectangles that tile `costs.pixels()`; some are empty if there are more leaves than
/// pixels. The longer side is cut, in proportion to the numbers of leaves on either side.
std::vector<volume::Rect> leaves_of_equal_cost(const CostImage& costs, int count);

}  // namespace understudy::compositor
