// SPDX-License-Identifier: Apache-2.0
// Checks whether a measured march still holds, and updates it when its table or its steps have changed. A few
// rays suffice, where measuring everything again takes hundreds.
#pragma once

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/sample_places.h"

namespace understudy::spu {

/// Returns the march with the transfer function that the program has now; null if more than that has changed.
std::optional<March> with_new_table(const MarchContext& measured, const March& march, const ProxyBox& box);

/// Returns the march with steps `factor` times as long, and samples that are corrected for this length, as is
/// usual, or unchanged; null if the program shows neither, as far as fields reveal. `offset`: of the probed
/// values, as in RaysLookedAt.
std::optional<March> with_longer_steps(const MarchContext& measured, const March& march, const ProxyBox& box,
                                       double factor, double offset);

/// Returns the march with its steps measured again, where the eye is inside and no ray is short; or why not.
std::variant<March, Refusal> with_new_steps(const MarchContext& measured, const March& march,
                                            const ProxyBox& box);

/// What still_marches() probes.
struct RaysLookedAt {
  int values = 8;       ///< evenly spread over the table, each on short rays
  double offset = 0.5;  ///< 0 to 1: where the first value lies, in units of the distance between two
  bool long_ray = true;
  bool light = true;  ///< and gradient opacity, on slopes
};

/// Whether a few rays through constant fields still look as `march` predicts.
bool still_marches(const MarchContext& measured, const March& march, const ProxyBox& box,
                   const RaysLookedAt& looked_at);

/// How closely the positions of samples are checked, and the reach of gradients.
struct PlacesLookedAt {
  bool samples = true;
  int values = 32;         ///< from which two that can be told apart are chosen
  bool predicted = false;  ///< by what the march predicts of their rays, instead of by drawing these
  SplitBands bands{};
  std::vector<std::size_t> axes_of_gradients{0, 1, 2};
};

/// Whether samples still lie where `march` places them, and gradients reach as far, as far as fields show.
bool still_placed(const MarchContext& measured, const March& march, const ProxyBox& box,
                  const PlacesLookedAt& looked_at);

}  // namespace understudy::spu
