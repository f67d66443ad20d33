// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario begun_by_noise() {
  return {
      .sentence = "Every ray is begun later by a part of a step that a texture of noise tells.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<std::uint8_t> noise;
        std::uint32_t state = 12345;
        for (int i = 0; i < 32 * 32; ++i) {
          state = state * 1664525U + 1013904223U;
          noise.push_back(static_cast<std::uint8_t>(state >> 24));
        }
        upload_mask_2d(canvas, 2, noise, 32);
        for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
          canvas.gl.TexParameteri(GL_TEXTURE_2D, name, GL_REPEAT);
        return
            [scene = caster_scene(
                 canvas,
                 {.fragment = caster_fragment_shader(
                      {.declarations = "uniform sampler2D noise;",
                       .before = "  vec4 sum = vec4(0.0);\n"
                                 "  vec3 late = step_length * texture(noise, gl_FragCoord.xy / 32.0).r\n"
                                 "              * direction;",
                       .each = "    vec4 colour = texture(table, vec2(texture(volume, here + late).r, 0.5));\n"
                               "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                       .after = "  shown = sum;"})})](int frame) {
              scene->program.use();
              scene->program.set("noise", 2);
              scene->draw(frame);
            };
      }};
}

}  // namespace adversary::casters
