// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario wireframe() {
  return {.sentence = "Slices are drawn as lines in frames 10 to 19.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              canvas.gl.PolygonMode(GL_FRONT_AND_BACK, frame / 10 == 1 ? GL_LINE : GL_FILL);
              scene->draw(frame);
              canvas.gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
            };
          }};
}

}  // namespace adversary::slices
