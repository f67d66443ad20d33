// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario first_hit() {
  return {.sentence = "The first sample above a threshold, in the colour of its place.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.fragment = caster_fragment_shader({.before = "  shown = vec4(0.0);",
                                                                     .each = "    if (value > 0.62) {\n"
                                                                             "      shown = vec4(here, 1.0);\n"
                                                                             "      break;\n"
                                                                             "    }"})})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
