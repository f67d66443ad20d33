// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/camera_followers.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

namespace understudy::spu {
namespace {

constexpr int changes_until_trusted = 3;

bool chooses(const MarchInputs& inputs, std::size_t vector) {
  return vector < inputs.varying_chooses.size() && inputs.varying_chooses[vector];
}

std::size_t name_of(const MarchInputs& inputs, std::size_t vector) {
  return vector < inputs.varying_names.size() ? inputs.varying_names[vector] : vector;
}

std::span<const float> values_of(const MarchInputs& inputs, std::size_t vector) {
  const std::vector<std::size_t>& begins = inputs.varying_begins;
  const std::size_t end = vector + 1 < begins.size() ? begins[vector + 1] : inputs.varying.size();
  return std::span(inputs.varying).subspan(begins[vector], end - begins[vector]);
}

/// Null if `inputs` has no vector of that name.
std::optional<std::span<const float>> values_named(const MarchInputs& inputs, std::size_t name) {
  for (std::size_t k = 0; k < inputs.varying_begins.size(); ++k) {
    if (name_of(inputs, k) == name) return values_of(inputs, k);
  }
  return std::nullopt;
}

}  // namespace

CameraFollowers::Moves& CameraFollowers::moves_of(std::size_t name, bool chooses, bool is_first) {
  const auto known = std::ranges::find(vectors_, name, &Moves::name);
  if (known != vectors_.end()) return *known;
  // A vector that appears later may have moved with the camera while a flag kept it from any effect.
  const int until_trusted = is_first || !chooses ? 0 : changes_until_trusted;
  return vectors_.emplace_back(Moves{.name = name, .until_trusted = until_trusted, .chose = chooses});
}

std::vector<bool> CameraFollowers::look(const MarchInputs& before, const MarchInputs& now, Camera camera) {
  // A camera that moves along one axis, or turns about another, leaves some of its vectors unchanged for a
  // while.
  constexpr int most_stayed = 4;
  constexpr int most_returns = 4;
  const bool turned = camera != Camera::stayed;
  const bool is_first = before.varying_begins.empty();
  const MarchInputs earlier = std::exchange(earlier_, before);
  std::vector<bool> follow;
  for (std::size_t k = 0; k < now.varying_begins.size(); ++k) {
    const std::span<const float> values = values_of(now, k);
    const std::size_t name = name_of(now, k);
    const bool chooses_now = chooses(now, k);
    Moves& vector = moves_of(name, chooses_now, is_first);
    const auto last = values_named(before, name);
    if (!turned || !last) {
      follow.insert(follow.end(), values.size(), turned && is_first);
      continue;
    }
    const auto is_as_in = [&](const auto& other) { return other && std::ranges::equal(values, *other); };
    const bool same = is_as_in(last);
    const bool returns = !same && camera == Camera::moved_on && is_as_in(values_named(earlier, name));
    if (returns) vector.returned = std::min(vector.returned + 1, most_returns);
    if (!same && (vector.stayed == most_stayed || (returns && vector.returned < most_returns)))
      vector.until_trusted = changes_until_trusted + 1;
    // The vector may have moved with the camera while a flag kept it from choosing anything.
    if (chooses_now && !std::exchange(vector.chose, chooses_now)) vector.until_trusted = changes_until_trusted;
    // A vector that chooses never regains trust: one without effect so far, such as a plane in front of the
    // volume, would be trusted just when it takes effect.
    if (!same && vector.until_trusted > 0 && !chooses_now) --vector.until_trusted;
    follow.insert(follow.end(), values.size(), same || vector.until_trusted == 0);
    vector.stayed = same ? std::min(vector.stayed + 1, most_stayed) : 0;
  }
  return follow;
}

void CameraFollowers::was_wrong() {
  for (Moves& vector : vectors_) vector.returned = 0;
}

}  // namespace understudy::spu
