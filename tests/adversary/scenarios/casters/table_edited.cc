// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario table_edited() {
  return {.sentence = "The table is replaced at frames 10 and 20 with glTexSubImage2D.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = caster_scene(canvas)](int frame) {
              if (frame == 10 || frame == 20) {
                const auto colours = frame == 10 ? other_colours() : step_colours();
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        colours.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
