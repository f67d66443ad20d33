// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario begun_by_formula() {
  return {
      .sentence = "Every ray is begun later by a part of a step that a formula of the pixel tells.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        return
            [scene = caster_scene(
                 canvas,
                 {.fragment = caster_fragment_shader(
                      {.before =
                           "  vec4 sum = vec4(0.0);\n"
                           "  float late = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5);",
                       .each = "    vec3 there = here + late * step_length * direction;\n"
                               "    vec4 colour = texture(table, vec2(texture(volume, there).r, 0.5));\n"
                               "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                       .after = "  shown = sum;"})})](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
