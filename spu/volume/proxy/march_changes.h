// SPDX-License-Identifier: Apache-2.0
// Whether a march that was measured still holds, and the march with what has changed: its table, its steps. A
// few rays tell, where measuring everything again takes hundreds.
#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/sample_places.h"

namespace understudy::spu {

/// The march with the transfer function that the program has now; null when more than that has changed.
std::optional<March> with_new_table(const MarchContext& measured, const March& march, const ProxyBox& box);

/// The march with steps that are `factor` times as long, whose samples are corrected for their length, as is
/// usual, or are what they were; null when neither is what the program shows, as far as fields tell. `offset`:
/// of the values that are looked at, as RaysLookedAt has it.
std::optional<March> with_longer_steps(const MarchContext& measured, const March& march, const ProxyBox& box,
                                       double factor, double offset);

/// The march with its steps measured once more, where the eye is inside and no ray is short; or why not.
std::variant<March, Refusal> with_new_steps(const MarchContext& measured, const March& march,
                                            const ProxyBox& box);

/// What still_marches() looks at.
struct RaysLookedAt {
  int values = 8;  ///< evenly spread over the table, each on a short ray
  double offset =
      0.5;  ///< 0 to 1: of the space between two values, how far the first lies behind the beginning
  bool long_ray = true;
};

/// Whether a few rays through constant fields still are as `march` says.
bool still_marches(const MarchContext& measured, const March& march, const ProxyBox& box,
                   const RaysLookedAt& looked_at);

/// How closely the places of samples are looked at, and of those that gradients are taken from.
struct PlacesLookedAt {
  int values = 32;  ///< of which two that tell are chosen
  SplitBands bands{};
  std::vector<std::size_t> axes_of_gradients{0, 1, 2};
};

/// Whether samples still lie on rays where `march` says, and their gradients look as far, as far as fields
/// tell.
bool still_placed(const MarchContext& measured, const March& march, const ProxyBox& box,
                  const PlacesLookedAt& looked_at);

}  // namespace understudy::spu
