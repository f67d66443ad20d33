// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario core_sum() {
  return {.sentence = "Sum of faint colours.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = slice_scene(canvas, {.table = premultiplied(soft_colours()),
                                              .blending = Blending::sum,
                                              .slices = 32,
                                              .background = {0, 0, 0, 1}})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
