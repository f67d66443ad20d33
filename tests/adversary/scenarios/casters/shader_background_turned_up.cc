// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_turned_up() {
  return {
      .sentence =
          "Blended as if premultiplied; a uniform tells how much of the shader's own background is put "
          "behind the composed colour and its alpha: none, from frame 12 on all, so that the alpha is 1, and "
          "from frame 22 on half.",
      .expectation = Expectation::either,
      .key_frames = {12, 22},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform float part;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = sum + part * (1.0 - sum.a) * vec4(0.8, 0.7, 0.5, 1.0);"}),
                     .background = {0.1F, 0.3F, 0.5F, 1}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("part", frame < 12 ? 0.0F : frame < 22 ? 1.0F : 0.5F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
