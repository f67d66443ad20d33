// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario background_in_shader() {
  return {
      .sentence = "Without blending; the shader composes over a background of its own, by the window's height.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        return [scene = caster_scene(
                    canvas,
                    {.fragment = caster_fragment_shader(
                         {.before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  vec3 sky = mix(vec3(0.3), vec3(0.2, 0.3, 0.9), gl_FragCoord.y / 256.0);\n"
                                   "  shown = vec4(sum.rgb + (1.0 - sum.a) * sky, 1.0);"}),
                     .blending = Blending::off})](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
