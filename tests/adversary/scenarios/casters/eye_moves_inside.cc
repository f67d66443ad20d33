// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario eye_moves_inside() {
  return {.sentence =
              "The eye moves through the box's front face into the volume; inside, front faces are cut by the "
              "near plane.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas)](int frame) {
              scene->settings.orbit.distance = 1.6F - 0.05F * static_cast<float>(frame);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
