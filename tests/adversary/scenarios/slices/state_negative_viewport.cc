// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_negative_viewport() {
  return {.sentence =
              "The viewport begins left of the window and below it, and is larger than the window. The table "
              "is replaced at frame 10.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              if (frame == 10) {
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        other_colours().data());
              }
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Viewport(-40, -40, canvas.width() + 80, canvas.height() + 80);
              scene->draw_slices(scene->camera(frame));
            };
          }};
}

}  // namespace adversary::slices
