// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_late_gradient() {
  return {.sentence =
              "Without blending; the shader composes over a background that goes from one colour to another "
              "along the window's diagonal. Both are the same until frame 11; from frame 12 on they differ, "
              "from frame 22 on they are the same again.",
          .expectation = Expectation::either,
          .key_frames = {12, 22},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas,
                {.fragment = caster_fragment_shader(
                     {.declarations = "uniform vec3 one;\nuniform vec3 other;\nuniform float diagonal;",
                      .before = "  vec4 sum = vec4(0.0);",
                      .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                              "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                      .after = "  float part = (gl_FragCoord.x + gl_FragCoord.y) / diagonal;\n"
                               "  shown = vec4(sum.rgb + (1.0 - sum.a) * mix(one, other, part), 1.0);"}),
                 .blending = Blending::off});
            return [&canvas, scene](int frame) {
              const Vector one{0.2F, 0.3F, 0.8F};
              scene->program.use();
              scene->program.set("one", one);
              scene->program.set("other", frame >= 12 && frame < 22 ? Vector{0.9F, 0.8F, 0.2F} : one);
              scene->program.set("diagonal", static_cast<float>(canvas.width() + canvas.height()));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
