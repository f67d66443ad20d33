// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario across_axes() {
  return {.sentence = "Slices across the axis nearest to the view; the axis changes as the camera turns.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.slices = 48, .across_axes = true, .orbit = {.azimuth = 33}})](
                       int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
