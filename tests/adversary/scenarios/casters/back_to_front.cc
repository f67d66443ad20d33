// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario back_to_front() {
  return {.sentence = "The loop composes from the far end of the ray to the near one.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(
                     canvas,
                     {.fragment = caster_fragment_shader(
                          {.before = "  vec4 sum = vec4(0.0);",
                           .each = "    vec3 there = at + float(count - 1 - i) * step_length * direction;\n"
                                   "    vec4 colour = texture(table, vec2(texture(volume, there).r, 0.5));\n"
                                   "    sum = vec4(colour.rgb * colour.a, colour.a) + (1.0 - colour.a) * sum;",
                           .after = "  shown = sum;"})})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
