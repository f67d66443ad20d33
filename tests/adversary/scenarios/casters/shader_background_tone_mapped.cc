// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_tone_mapped() {
  return {
      .sentence =
          "Without blending; what is composed over the shader's background is compressed by an exposure and "
          "raised to 1/2.2, background and all, with an alpha of 1. The exposure changes at frame 14.",
      .expectation = Expectation::either,
      .key_frames = {14},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform float exposure;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  vec3 light = sum.rgb + (1.0 - sum.a) * vec3(0.3, 0.1, 0.4);\n"
                                   "  light = vec3(1.0) - exp(-exposure * light);\n"
                                   "  shown = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);"}),
                     .blending = Blending::off});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("exposure", frame < 14 ? 1.0F : 2.5F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
