// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario over() {
  return {.sentence = "Front faces of a box, samples composed front to back, table in a 2-D texture.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas)](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
