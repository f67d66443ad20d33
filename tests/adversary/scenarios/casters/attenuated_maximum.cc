// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario attenuated_maximum() {
  return {.sentence = "A maximum in which values fade with their distance along the ray.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas,
                        {.fragment = caster_fragment_shader(
                             {.before = "  float largest = 0.0;",
                              .each = "    largest = max(largest, value * exp(-1.2 * float(i) * step_length));",
                              .after = "  shown = texture(table, vec2(largest, 0.5));"}),
                         .table = opaque_colours()})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
