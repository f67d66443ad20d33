// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shown_part_with_a_hole() {
  return {.sentence =
              "The shader discards what lies outside of its view; from frame 10 on also what lies in a smaller "
              "rectangle in it, from frame 20 on there only every other pixel.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec4 view, hole;\nuniform int kind;",
                 .before = R"(
  vec2 place = gl_FragCoord.xy;
  if (any(lessThan(place, view.xy)) || any(greaterThan(place, view.zw))) discard;
  bool in_hole = all(greaterThan(place, hole.xy)) && all(lessThan(place, hole.zw));
  bool other = mod(floor(place.x) + floor(place.y), 2.0) > 0.5;
  if (in_hole && (kind == 1 || (kind == 2 && other))) discard;
  vec4 sum = vec4(0.0);)",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.Uniform4f(scene->program.location("view"), 20, 24, 236, 228);
              canvas.gl.Uniform4f(scene->program.location("hole"), 96, 84, 168, 160);
              scene->program.set("kind", frame / 10);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
