// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_background_white_without_blending() {
  return {
      .sentence =
          "Without blending; the shader mixes white and the composed colour by its alpha and writes an alpha "
          "of 1, in a dark green window. At frame 15 the camera comes nearer at once.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene =
            caster_scene(canvas, {.fragment = caster_fragment_shader(
                                      {.declarations = "const vec3 background = vec3(1.0);",
                                       .before = "  vec4 sum = vec4(0.0);",
                                       .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                               "    sum.rgb += (1.0 - sum.a) * colour.a * colour.rgb;\n"
                                               "    sum.a += (1.0 - sum.a) * colour.a;",
                                       .after = "  vec3 colour = sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);\n"
                                                "  shown = vec4(mix(background, colour, sum.a), 1.0);"}),
                                  .blending = Blending::off,
                                  .background = {0.05F, 0.25F, 0.1F, 1}});
        return [scene](int frame) {
          scene->settings.orbit.distance = frame < 15 ? 3.0F : 2.0F;
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
