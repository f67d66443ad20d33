// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario own_background_coarse_while_dragging() {
  return {
      .sentence =
          "Over paper's colour in the shader, with an alpha of 1, blended by the alpha. In frames 7 to 13 and "
          "21 to 27 the user drags: steps are two and a half times as long, and the opacity is corrected.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {7, 14, 21, 28},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "const vec3 paper = vec3(0.96, 0.94, 0.88);",
                          .before = "  vec3 light = vec3(0.0);\n  float alpha = 0.0;",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    float opacity = 1.0 - pow(1.0 - colour.a, step_length / 0.02);\n"
                                  "    light += (1.0 - alpha) * opacity * colour.rgb;\n"
                                  "    alpha += (1.0 - alpha) * opacity;",
                          .after = "  shown.rgb = light + (1.0 - alpha) * paper;\n  shown.a = 1.0;"}),
                     .blending = Blending::over,
                     .background = {0.3F, 0.35F, 0.4F, 1}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("step_length", frame / 7 % 2 == 0 ? 0.02F : 0.05F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
