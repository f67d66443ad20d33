// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_after_many_changes() {
  return {.sentence =
              "The program has replaced nothing of a mask seventeen million times, which is more than a float "
              "counts. The table is replaced at frame 10, and in every frame from then on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas);
            upload_mask_2d(canvas, 2, {0, 0, 0, 0}, 2);
            for (int i = 0; i < 17'000'000; ++i)
              canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame >= 10) {
                const auto colours = frame % 2 == 0 ? other_colours() : soft_colours();
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        colours.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
