// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario discards_outside_its_view() {
  return {.sentence =
              "The shader discards what lies outside of its view in the window, which is smaller from "
              "frame 15 on; the volume is larger than the view.",
          .expectation = Expectation::either,
          .key_frames = {15},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec3 low, high;",
                 .before = "  vec2 place = gl_FragCoord.xy;\n"
                           "  if (any(lessThan(place, low.xy)) || any(greaterThan(place, high.xy))) discard;\n"
                           "  vec4 sum = vec4(0.0);",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("low", frame < 15 ? Vector{40, 35, 0} : Vector{60, 50, 0});
              scene->program.set("high", frame < 15 ? Vector{220, 230, 0} : Vector{180, 200, 0});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
