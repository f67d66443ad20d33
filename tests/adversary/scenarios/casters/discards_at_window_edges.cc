// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario discards_at_window_edges() {
  return {.sentence = "The shader discards the pixels at the window's edges, beyond which the volume reaches.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec3 low, high;",
                 .before = "  vec2 place = gl_FragCoord.xy;\n"
                           "  if (any(lessThan(place, low.xy)) || any(greaterThan(place, high.xy))) discard;\n"
                           "  vec4 sum = vec4(0.0);",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader, .orbit = {.sideways = 0.3F}});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("low", Vector{1.5F, 1.5F, 0});
              scene->program.set("high", Vector{254.5F, 254.5F, 0});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
