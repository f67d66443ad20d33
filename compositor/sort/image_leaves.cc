// SPDX-License-Identifier: Apache-2.0
#include "compositor/sort/image_leaves.h"

#include <algorithm>
#include <numeric>

namespace understudy::compositor {

using volume::Rect;

namespace {

/// The two parts of a rectangle that is cut at `cut` across its longer side.
struct Halves {
  Rect low, high;
};

bool is_wide(const Rect& rect) {
  return rect.width >= rect.height;
}

Halves cut_at(const Rect& rect, int cut) {
  Halves halves{rect, rect};
  if (is_wide(rect)) {
    halves.low.width = cut - rect.x;
    halves.high.x = cut;
    halves.high.width = rect.x + rect.width - cut;
  } else {
    halves.low.height = cut - rect.y;
    halves.high.y = cut;
    halves.high.height = rect.y + rect.height - cut;
  }
  return halves;
}

/// Rounds `at` to the nearest multiple of the alignment.
int aligned(int at) {
  const int remainder = ((at % leaf_alignment) + leaf_alignment) % leaf_alignment;
  return remainder * 2 < leaf_alignment ? at - remainder : at - remainder + leaf_alignment;
}

/// Returns where the low side has `share` of the cost, or of the pixels if nothing has a cost.
int fair_cut(const CostImage& costs, const Rect& rect, double share) {
  const int first = is_wide(rect) ? rect.x : rect.y;
  const int length = is_wide(rect) ? rect.width : rect.height;
  const double wanted = share * costs.within(rect);
  if (!(wanted > 0)) return first + int(share * length);
  int low = first, high = first + length;
  while (low < high) {
    const int middle = std::midpoint(low, high);
    if (costs.within(cut_at(rect, middle).low) < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return std::clamp(aligned(low), first, first + length);
}

void cut(const CostImage& costs, const Rect& rect, int count, std::vector<Rect>& leaves) {
  if (count == 1) return leaves.push_back(rect);
  const int below = count / 2;
  const Halves halves = cut_at(rect, fair_cut(costs, rect, double(below) / count));
  cut(costs, halves.low, below, leaves);
  cut(costs, halves.high, count - below, leaves);
}

}  // namespace

std::vector<Rect> leaves_of_equal_cost(const CostImage& costs, int count) {
  std::vector<Rect> leaves;
  leaves.reserve(std::size_t(count));
  cut(costs, costs.pixels(), count, leaves);
  return leaves;
}

}  // namespace understudy::compositor
