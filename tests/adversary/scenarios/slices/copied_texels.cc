// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario copied_texels() {
  return {.sentence = "Texels of another texture are copied into the volume by the driver at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas);
            const GLuint other = upload_volume(canvas, 4, sampled(48, shells));
            return [&canvas, scene, other](int frame) {
              if (frame == 10)
                canvas.gl.CopyImageSubData(other, GL_TEXTURE_3D, 0, 0, 0, 0, scene->volume, GL_TEXTURE_3D, 0, 0,
                                           0, 16, 48, 48, 32);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
