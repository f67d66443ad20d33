// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario minimum() {
  return {.sentence = "The smallest value along the ray, through a table of opaque colours.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                   {.before = "  float smallest = 1.0;",
                                                    .each = "    smallest = min(smallest, value);",
                                                    .after = "  shown = texture(table, vec2(smallest, 0.5));"}),
                                               .table = opaque_colours()})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
