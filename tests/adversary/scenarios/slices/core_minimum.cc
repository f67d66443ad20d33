// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario core_minimum() {
  return {.sentence = "Minimum of opaque colours from a table, on white.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = slice_scene(canvas, {.table = opaque_colours(),
                                              .blending = Blending::minimum,
                                              .background = {1, 1, 1, 1}})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
