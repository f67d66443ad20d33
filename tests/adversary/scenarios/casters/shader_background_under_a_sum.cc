// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_under_a_sum() {
  return {
      .sentence =
          "Not composed by \"over\": the samples' colours, weighted by their opacity, are added up on the "
          "background's colour, and an alpha of 1 is written, which blending by the alpha replaces with. The "
          "background changes at frame 16.",
      .expectation = Expectation::either,
      .key_frames = {16},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader({.declarations = "uniform vec3 background;",
                                                 .before = "  vec3 sum = background;",
                                                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                                         "    sum += 0.3 * colour.a * colour.rgb;",
                                                 .after = "  shown = vec4(sum, 1.0);"}),
             .blending = Blending::over,
             .background = {0.5F, 0.5F, 0.1F, 1}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("background", frame < 16 ? Vector{} : Vector{0.1F, 0.2F, 0.3F});
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
