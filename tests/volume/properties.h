// SPDX-License-Identifier: Apache-2.0
// Properties of every image of a random scene: it is finite, the same for any partition, and mirrored when the
// scene is. An image of a coloured medium has no opacity above 1 and no colour brighter than the medium's.
#pragma once

#include "tests/volume/parts.h"

namespace understudy::volume::testing {

struct PropertyTrials {
  const char* renderer = "";
  int trials = 0;
  bool may_refuse = false;  ///< scenes with segments or wild texels
  double apart = 1e-5;  ///< tolerance between two partitions, and per unit of steepness between mirror images
};

/// Checks these properties on `trials` scenes. Prints the seed and the worst values; a failure names its scene.
void expect_properties(const PropertyTrials& asked, const DrawBricks& draw);

}  // namespace understudy::volume::testing
