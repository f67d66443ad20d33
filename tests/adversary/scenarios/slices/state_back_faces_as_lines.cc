// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_back_faces_as_lines() {
  return {.sentence =
              "The slices show their back faces to the eye. Back faces, and they alone, are drawn as lines "
              "from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              if (frame == 10) canvas.gl.PolygonMode(GL_BACK, GL_LINE);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
