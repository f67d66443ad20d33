// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario mipmapped_table_of_one_level() {
  return {
      .sentence =
          "The table is filtered by mipmaps, and its last level is the first. At frame 10 its colours change.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas);
        canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        canvas.gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        return [&canvas, scene](int frame) {
          canvas.gl.ActiveTexture(GL_TEXTURE1);
          if (frame == 10)
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                    other_colours().data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
