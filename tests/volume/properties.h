// SPDX-License-Identifier: Apache-2.0
// What holds of every image, on random scenes: it is finite, the same for any partition, mirrored when the
// scene is, and of a coloured medium it shows no opacity above 1 and no colour brighter than the medium's.
#pragma once

#include "tests/volume/parts.h"

namespace understudy::volume::testing {

struct PropertyTrials {
  const char* renderer = "";
  int trials = 0;
  bool may_refuse = false;  ///< segments, and texels that are no numbers
  double apart = 1e-5;  ///< by which images of two partitions may differ, and each unit of mirrored steepness
};

/// Expects it of `trials` scenes. Prints the seed and the worst values; a failure says which scene it was.
void expect_properties(const PropertyTrials& asked, const DrawBricks& draw);

}  // namespace understudy::volume::testing
