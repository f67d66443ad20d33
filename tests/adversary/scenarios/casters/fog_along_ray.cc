// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario fog_along_ray() {
  return {.sentence = "Samples fade into the background's colour with their distance from the eye.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas, {.fragment = over_caster("", R"(
    colour.rgb = mix(vec3(0.1, 0.12, 0.2), colour.rgb, exp(-0.8 * max(0.0, distance(here, eye) - 1.8)));)")})](
                       int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
