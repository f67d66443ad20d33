// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario coarser_level() {
  return {.sentence = "Texels of a coarser level of detail are shown from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float level;)",
                                                                       R"(
  colour = texture(table, vec2(textureLod(volume, here, level).r, 0.5));)")});
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            canvas.gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
            canvas.gl.GenerateMipmap(GL_TEXTURE_3D);
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("level", frame < 10 ? 0.0F : 2.5F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
