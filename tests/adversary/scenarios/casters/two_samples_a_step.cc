// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario two_samples_a_step() {
  return {.sentence = "Segments: the sample and the one before look up the table at their mean.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas,
                        {.fragment = caster_fragment_shader(
                             {.before = "  vec4 sum = vec4(0.0);\n  float before = texture(volume, at).r;",
                              .each = "    vec4 colour = texture(table, vec2(0.5 * (before + value), 0.5));\n"
                                      "    before = value;\n"
                                      "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                              .after = "  shown = sum;"})})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
