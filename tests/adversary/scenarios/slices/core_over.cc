// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario core_over() {
  return {.sentence = "Slices in one batch, OpenGL 3.3 core, a table in a 2-D texture, over.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas)](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
