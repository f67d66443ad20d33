// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario explicit_level_of_table() {
  return {.sentence =
              "Level 0 of a table with mipmaps is named in the shader. From frame 10 on, the lowest level that "
              "may be looked up is the seventh. The camera stays.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string caster = caster_fragment_shader({.before = "  vec4 sum = vec4(0.0);",
                                                               .each = R"(
    vec4 colour = textureLod(table, vec2(value, 0.5), 0.0);
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);)",
                                                               .after = "  shown = sum;"});
            auto scene = caster_scene(canvas, {.fragment = caster, .orbit = {.degrees_each_frame = 0}});
            canvas.gl.GenerateMipmap(GL_TEXTURE_2D);
            canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame == 10) canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_LOD, 6);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
