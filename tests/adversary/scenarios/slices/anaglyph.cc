// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario anaglyph() {
  return {.sentence = "Red from the left eye, green and blue from the right one, by colour masks.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.ColorMask(GL_TRUE, GL_FALSE, GL_FALSE, GL_FALSE);
              scene->draw_slices(camera_at({.azimuth = 28}, frame));
              canvas.gl.ColorMask(GL_FALSE, GL_TRUE, GL_TRUE, GL_FALSE);
              scene->draw_slices(camera_at({.azimuth = 32}, frame));
              canvas.gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
            };
          }};
}

}  // namespace adversary::slices
