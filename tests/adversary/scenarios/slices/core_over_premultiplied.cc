// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario core_over_premultiplied() {
  return {.sentence = "Slices whose table holds premultiplied colours, blended by ONE, ONE_MINUS_SRC_ALPHA.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.table = premultiplied(soft_colours()),
                                                 .blending = Blending::premultiplied_over})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
