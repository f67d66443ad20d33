// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario part_uploaded() {
  return {
      .sentence = "A box in the midst of the volume is replaced at frames 10 and 15.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10, 15},
      .start = [](Canvas& canvas) -> DrawFrame {
        return [&canvas, scene = slice_scene(canvas)](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE0);
          const Grid other = sampled(48, shells);
          if (frame == 10)
            replace_texels(canvas, part_of(other, 10, 5, 20, 20, 25, 15), scene->settings.format, 10, 5, 20);
          if (frame == 15)
            replace_texels(canvas, part_of(other, 30, 30, 3, 17, 11, 40), scene->settings.format, 30, 30, 3);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
