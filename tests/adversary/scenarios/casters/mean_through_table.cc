// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_through_table() {
  return {.sentence =
              "The mean of the values along the ray, through a table; from frame 12 on only of those above a "
              "limit.",
          .expectation = Expectation::either,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform float limit;",
                 .before = "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    if (value < limit) continue;\n    sum += value;\n    ++taken;",
                 .after = "  if (taken == 0u) discard;\n"
                          "  vec4 colour = texture(table, vec2(sum / float(taken), 0.5));\n"
                          "  shown = vec4(colour.rgb * colour.a, colour.a);"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 12 ? -1.0F : 0.4F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
