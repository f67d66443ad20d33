// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_of_colours_edited() {
  return {
      .sentence =
          "The mean of the samples' colours; at frame 11 all of the table is replaced, at frame 21 few of its "
          "entries.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {11, 21},
      .start = [](Canvas& canvas) -> DrawFrame {
        const std::string shader =
            caster_fragment_shader({.before = "  vec3 sum = vec3(0.0);\n  int taken = 0;",
                                    .each = "    sum += texture(table, vec2(value, 0.5)).rgb;\n    ++taken;",
                                    .after = "  shown = vec4(clamp(sum / float(taken), 0.0, 1.0), 1.0);"});
        auto scene = caster_scene(canvas, {.fragment = shader, .table = opaque_colours()});
        return [&canvas, scene](int frame) {
          const std::vector<Colour> white(16, {255, 255, 255, 255});
          canvas.gl.ActiveTexture(GL_TEXTURE1);
          if (frame == 11)
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                    other_colours().data());
          if (frame == 21)
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 140, 0, 16, 1, GL_RGBA, GL_UNSIGNED_BYTE, white.data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
