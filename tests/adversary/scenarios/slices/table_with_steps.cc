// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario table_with_steps() {
  return {.sentence = "A table of four colours with sharp borders, looked up without interpolation.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.table = step_colours()});
            filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
