// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario opacities_added_up() {
  return {.sentence = "Colours and opacities are added up, not composed.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.fragment = caster_fragment_shader(
                                     {.before = "  vec4 sum = vec4(0.0);",
                                      .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                              "    sum += 0.3 * vec4(colour.rgb * colour.a, colour.a);",
                                      .after = "  shown = min(sum, vec4(1.0));"})})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
