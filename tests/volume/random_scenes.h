// SPDX-License-Identifier: Apache-2.0
// Scenes with random fields, transfer functions, cameras and samples, the same for the same seed.
#pragma once

#include <random>
#include <string>

#include "tests/volume/fields.h"
#include "volume/request.h"

namespace understudy::volume::testing {

/// UNDERSTUDY_TEST_SEED of the environment, or a fixed default.
unsigned test_seed();

struct RandomScene {
  Texture texture;
  RenderRequest request;
  /// Colour is at most opacity times the brightest colour.
  bool coloured_medium = false;
  /// Some texels are NaN, infinite, huge or denormal.
  bool wild_texels = false;
  /// Largest change of colour or opacity per unit of the field's value; 1 for an even ramp.
  double steepness = 0;
  std::string text;  ///< one line that describes the scene
};

RandomScene random_scene(std::mt19937& random);

}  // namespace understudy::volume::testing
