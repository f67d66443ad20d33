// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_some_channels() {
  return {.sentence =
              "Without blending; in frames 10 to 19 the colour mask keeps the background's green, from frame "
              "15 on a "
              "scissor box that moves shows a part of the volume.",
          .expectation = Expectation::either,
          .key_frames = {10, 15, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.blending = Blending::off});
            return [&canvas, scene](int frame) {
              canvas.begin(0.25F, 0.75F, 0.4F);
              if (frame / 10 == 1) canvas.gl.ColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_TRUE);
              if (frame >= 15) canvas.gl.Enable(GL_SCISSOR_TEST);
              canvas.gl.Scissor(5 * frame, 40, 100, 170);
              scene->draw_box(scene->camera(frame));
              canvas.gl.Disable(GL_SCISSOR_TEST);
              canvas.gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
            };
          }};
}

}  // namespace adversary::casters
