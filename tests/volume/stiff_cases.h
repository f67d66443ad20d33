// SPDX-License-Identifier: Apache-2.0
// Stiff transfer functions, unusual fields and hard views, each with its bounds, for every ray caster.
#pragma once

#include <string>
#include <vector>

#include "tests/volume/parts.h"
#include "volume/request.h"

namespace understudy::volume::testing {

struct StiffCase {
  std::string name;
  Texture texture;
  RenderRequest request;
  /// Largest difference from the reference in any component, and between one rank and four.
  double bound = 5e-5;
  double apart = 1e-5;
};

std::vector<StiffCase> stiff_tables();
std::vector<StiffCase> stiff_fields();
std::vector<StiffCase> stiff_views();

/// Draws the case under every operator on one rank and on four, expects it within its bounds, and prints the
/// worst values as a table row.
void expect_within_bounds(const StiffCase& one, const char* renderer, const DrawBricks& draw);

}  // namespace understudy::volume::testing
