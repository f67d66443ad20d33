// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_background_of_other_alpha() {
  return {.sentence =
              "Backgrounds in the shader take turns: of one colour, but with an alpha of 1 or 0.5, over a "
              "bright window; "
              "from frame 10 on 0.9 in place of 1, from frame 20 on also 0.95, and 0 in place of 0.5.",
          .expectation = Expectation::either,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = caster_fragment_shader(
                             {.declarations = "uniform vec3 background;\nuniform float background_alpha;",
                              .before = "  vec4 sum = vec4(0.0);",
                              .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                      "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                              .after = "  shown = sum + (1.0 - sum.a) * vec4(background, background_alpha);"}),
                         .background = {0.8F, 0.75F, 0.6F, 1}});
            return [scene](int frame) {
              const bool even = frame % 2 == 0;
              float alpha = even ? 1.0F : 0.5F;
              if (frame >= 10 && even) alpha = 0.9F;
              if (frame >= 20) alpha = frame % 4 == 0 ? 0.95F : even ? 0.9F : 0.0F;
              scene->program.use();
              scene->program.set("background", Vector{0.05F, 0.1F, 0.15F});
              scene->program.set("background_alpha", alpha);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
