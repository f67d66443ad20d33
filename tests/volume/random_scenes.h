// SPDX-License-Identifier: Apache-2.0
// Scenes that nobody thought of: random fields, tables, cameras and samples, the same for the same seed.
#pragma once

#include <random>
#include <string>

#include "tests/volume/fields.h"
#include "volume/request.h"

namespace understudy::volume::testing {

/// The environment's UNDERSTUDY_TEST_SEED, or else always the same.
unsigned test_seed();

struct RandomScene {
  Texture texture;
  RenderRequest request;
  /// Colour is that of a medium: at most opacity times the brightest colour.
  bool coloured_medium = false;
  /// Among the texels are values that are no numbers, infinite, huge or denormal.
  bool wild_texels = false;
  /// Most that colour or opacity change a unit of the field's value, beside an even ramp's 1.
  double steepness = 0;
  std::string text;  ///< of what kind, in a line
};

RandomScene random_scene(std::mt19937& random);

}  // namespace understudy::volume::testing
