// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_by_uniform() {
  return {
      .sentence =
          "The composed colour is shown over a uniform's colour with an alpha of 1, blended as if "
          "premultiplied. The user chooses that colour: it changes at frames 8 and 16, and is dragged from "
          "frame 20 to 24.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {8, 16, 20, 21, 22, 23, 24},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform vec3 background;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = vec4(sum.rgb + (1.0 - sum.a) * background, 1.0);"}),
                     .blending = Blending::premultiplied_over,
                     .background = {0.4F, 0.4F, 0.4F, 1}});
        return [scene](int frame) {
          const float dragged = frame < 20 ? 0.0F : frame < 24 ? 0.2F * static_cast<float>(frame - 19) : 1.0F;
          scene->program.use();
          scene->program.set("background", frame < 8    ? Vector{0.1F, 0.2F, 0.6F}
                                           : frame < 16 ? Vector{0.95F, 0.9F, 0.3F}
                                                        : Vector{0.7F * dragged, 0.5F, 1 - dragged});
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
