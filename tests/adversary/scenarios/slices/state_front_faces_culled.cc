// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_front_faces_culled() {
  return {.sentence =
              "The slices show their front faces to the eye. Front faces are culled from frame 10 on, so that "
              "nothing is left of them.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            canvas.gl.FrontFace(GL_CW);
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              if (frame == 10) {
                canvas.gl.Enable(GL_CULL_FACE);
                canvas.gl.CullFace(GL_FRONT);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
