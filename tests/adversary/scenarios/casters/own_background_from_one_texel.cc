// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario own_background_from_one_texel() {
  return {
      .sentence =
          "An alpha of 1, blended as if premultiplied; the shader's background is fetched from a texture of "
          "one texel, whose colour is replaced at frame 13; another such texture is bound from frame 21 on.",
      .expectation = Expectation::either,
      .key_frames = {13, 21},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform sampler2D backdrop;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  vec3 behind = texture(backdrop, vec2(0.5)).rgb;\n"
                                   "  shown = vec4(sum.rgb + (1.0 - sum.a) * behind, 1.0);"}),
                     .background = {0.25F, 0.25F, 0.25F, 1}});
        const GLuint other = upload_table_2d(canvas, 2, {Colour{240, 200, 60, 255}});
        const GLuint first = upload_table_2d(canvas, 2, {Colour{200, 215, 235, 255}});
        scene->program.use();
        scene->program.set("backdrop", 2);
        return [&canvas, scene, first, other](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE2);
          canvas.gl.BindTexture(GL_TEXTURE_2D, frame < 21 ? first : other);
          if (frame == 13) {
            const Colour night{20, 25, 70, 255};
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, night.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
