// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario mipmapped_table_least_level() {
  return {.sentence =
              "A table has mipmaps, of which only the first is looked up. From frame 10 on it is at least the "
              "fifth.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.table = step_colours()});
            canvas.gl.GenerateMipmap(GL_TEXTURE_2D);
            canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
            canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LOD, 0);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame == 10) {
                canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LOD, 1000);
                canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_LOD, 6);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
