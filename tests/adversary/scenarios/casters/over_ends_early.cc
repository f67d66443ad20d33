// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario over_ends_early() {
  return {.sentence = "Rays end where their opacity passes 0.99.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(
                     canvas, {.fragment = caster_fragment_shader(
                                  {.before = "  vec4 sum = vec4(0.0);",
                                   .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                           "    colour.a = min(1.0, 3.0 * colour.a);\n"
                                           "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                                           "    if (sum.a > 0.99) break;",
                                   .after = "  shown = sum;"})})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
