// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario first_hit_through_table() {
  return {.sentence = "The first sample above a threshold, opaque, in its colour of the table.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.fragment = caster_fragment_shader(
                                     {.before = "  shown = vec4(0.0);",
                                      .each = "    if (value > 0.62) {\n"
                                              "      shown = vec4(texture(table, vec2(value, 0.5)).rgb, 1.0);\n"
                                              "      break;\n"
                                              "    }"})})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
