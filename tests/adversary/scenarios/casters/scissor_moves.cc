// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario scissor_moves() {
  return {.sentence = "A scissor box that moves shows a part of the volume.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = caster_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Enable(GL_SCISSOR_TEST);
              canvas.gl.Scissor(20 + 3 * frame, 30, 120, 150);
              scene->draw_box(scene->camera(frame));
              canvas.gl.Disable(GL_SCISSOR_TEST);
            };
          }};
}

}  // namespace adversary::casters
