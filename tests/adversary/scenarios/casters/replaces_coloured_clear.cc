// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_coloured_clear() {
  return {.sentence = "Without blending: the composed colour replaces an orange background where the box is.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.blending = Blending::off, .background = {0.9F, 0.45F, 0.1F, 1}})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
