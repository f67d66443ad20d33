// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_mixed_over_paper() {
  return {.sentence =
              "Without blending; the shader composes over a colour of its own and writes an alpha of 1. That "
              "colour "
              "is white, from frame 10 on black, and from frame 20 on different in every frame.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = caster_fragment_shader(
                             {.declarations = "uniform vec3 paper;",
                              .before = "  vec4 sum = vec4(0.0);",
                              .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                      "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                              .after = "  shown = vec4(mix(paper, sum.rgb / max(sum.a, 1e-6), sum.a), 1.0);"}),
                         .blending = Blending::off,
                         .background = {0.2F, 0.5F, 0.3F, 1}});
            return [scene](int frame) {
              const float part = static_cast<float>(frame - 20) / 10;
              scene->program.use();
              scene->program.set("paper", frame < 10   ? Vector{1, 1, 1}
                                          : frame < 20 ? Vector{}
                                                       : Vector{0.8F, 0.9F * part, 1 - part});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
