// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario steps_by_value() {
  return {.sentence = "Steps are twice as long where values are low.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(
                     canvas, {.fragment = caster_fragment_shader(
                                  {.before = "  vec4 sum = vec4(0.0);\n  float gone = 0.0;",
                                   .each = "    if (gone > float(count) * step_length) break;\n"
                                           "    float there = texture(volume, at + gone * direction).r;\n"
                                           "    vec4 colour = texture(table, vec2(there, 0.5));\n"
                                           "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                                           "    gone += there < 0.4 ? 2.0 * step_length : step_length;",
                                   .after = "  shown = sum;"})})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
