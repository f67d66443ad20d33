// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/camera_followers.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace understudy::spu {
namespace {

bool chooses(const MarchInputs& inputs, std::size_t vector) {
  return vector < inputs.varying_chooses.size() && inputs.varying_chooses[vector];
}

}  // namespace

std::vector<bool> CameraFollowers::look(const MarchInputs& before, const MarchInputs& now, Camera camera) {
  // A camera that moves along one axis, or turns about another, leaves some of its vectors as they are for a
  // while.
  constexpr int most_stayed = 4;
  constexpr int changes_until_trusted = 3;
  constexpr int most_returns = 4;
  const bool turned = camera != Camera::stayed;
  const std::vector<std::size_t>& begins = now.varying_begins;
  std::vector<bool> follow(now.varying.size(), turned);
  const std::vector<float> earlier = std::exchange(earlier_, before.varying);
  if (before.varying_begins != begins || vectors_.size() != begins.size()) {
    vectors_.assign(begins.size(), {});
    for (std::size_t k = 0; k < begins.size(); ++k) vectors_[k].chose = chooses(now, k);
    return follow;
  }
  if (!turned) return follow;
  for (std::size_t k = 0; k < begins.size(); ++k) {
    const std::size_t end = k + 1 < begins.size() ? begins[k + 1] : now.varying.size();
    const auto is_as_in = [&](const std::vector<float>& other) {
      return other.size() == now.varying.size() &&
             std::equal(now.varying.begin() + std::ptrdiff_t(begins[k]),
                        now.varying.begin() + std::ptrdiff_t(end), other.begin() + std::ptrdiff_t(begins[k]));
    };
    Moves& vector = vectors_[k];
    const bool same = is_as_in(before.varying);
    const bool returns = !same && camera == Camera::moved_on && is_as_in(earlier);
    if (returns) vector.returned = std::min(vector.returned + 1, most_returns);
    if (!same && (vector.stayed == most_stayed || (returns && vector.returned < most_returns)))
      vector.until_trusted = changes_until_trusted + 1;
    // What shows nothing yet, as a plane before the volume, would be trusted when it does.
    const bool chooses_now = chooses(now, k);
    // It may have moved with the camera while a flag kept it from choosing anything.
    if (chooses_now && !std::exchange(vector.chose, chooses_now)) vector.until_trusted = changes_until_trusted;
    if (!same && vector.until_trusted > 0 && !chooses_now) --vector.until_trusted;
    std::fill(follow.begin() + std::ptrdiff_t(begins[k]), follow.begin() + std::ptrdiff_t(end),
              same || vector.until_trusted == 0);
    vector.stayed = same ? std::min(vector.stayed + 1, most_stayed) : 0;
  }
  return follow;
}

void CameraFollowers::was_wrong() {
  for (Moves& vector : vectors_) vector.returned = 0;
}

}  // namespace understudy::spu
