// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario sum_of_samples() {
  return {.sentence = "Samples are added up under one opacity, as an X-ray image.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                   {.before = "  float sum = 0.0;",
                                                    .each = "    sum += 0.02 * value;",
                                                    .after = "  shown = vec4(vec3(min(sum, 1.0)), 1.0);"})})](
                    int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
