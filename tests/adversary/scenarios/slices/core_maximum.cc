// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario core_maximum() {
  return {.sentence = "Maximum of opaque colours from a table.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = slice_scene(canvas, {.table = opaque_colours(),
                                              .blending = Blending::maximum,
                                              .background = {0, 0, 0, 1}})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
