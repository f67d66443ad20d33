// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario over_not_premultiplied() {
  return {.sentence = "The composed colour is divided by its opacity and blended by SRC_ALPHA.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(
                     canvas, {.fragment = caster_fragment_shader(
                                  {.before = "  vec4 sum = vec4(0.0);",
                                   .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                           "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                                   .after = "  shown = vec4(sum.rgb / max(sum.a, 1e-6), sum.a);"}),
                              .blending = Blending::over})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
