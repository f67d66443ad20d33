// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario parallel_projection() {
  return {.sentence = "Slices in parallel projection.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.orbit = {.projection = Projection::parallel}})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
