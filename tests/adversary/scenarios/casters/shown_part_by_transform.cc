// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shown_part_by_transform() {
  return {.sentence =
              "The shader takes gl_FragCoord into its view's own coordinates and discards what lies outside of "
              "0 to 1; the volume lies partly outside. The view moves and grows at frame 14.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform vec4 view_from_window;",
                 .before = "  vec2 place = gl_FragCoord.xy * view_from_window.xy + view_from_window.zw;\n"
                           "  if (place.x < 0.0 || place.x > 1.0 || place.y < 0.0 || place.y > 1.0) discard;\n"
                           "  vec4 sum = vec4(0.0);",
                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                         "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                 .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [&canvas, scene](int frame) {
              const float left = frame < 14 ? 30.0F : 84.0F, bottom = frame < 14 ? 40.0F : 16.0F;
              const float width = frame < 14 ? 140.0F : 160.0F, height = frame < 14 ? 170.0F : 200.0F;
              scene->program.use();
              canvas.gl.Uniform4f(scene->program.location("view_from_window"), 1 / width, 1 / height,
                                  -left / width, -bottom / height);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
