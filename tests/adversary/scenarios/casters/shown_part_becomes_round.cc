// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shown_part_becomes_round() {
  return {.sentence =
              "The shader discards what lies outside of a rectangle of the window; in frames 15 to 23 what "
              "lies outside of the ellipse in it.",
          .expectation = Expectation::either,
          .key_frames = {15, 24},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec4 view;\nuniform int rounded;",
                 .before = "  vec2 away = abs(gl_FragCoord.xy - view.xy) / view.zw;\n"
                           "  if ((rounded == 1 ? length(away) : max(away.x, away.y)) > 1.0) discard;\n"
                           "  vec4 sum = vec4(0.0);",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.Uniform4f(scene->program.location("view"), 122, 130, 86, 78);
              scene->program.set("rounded", frame < 15 || frame >= 24 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
