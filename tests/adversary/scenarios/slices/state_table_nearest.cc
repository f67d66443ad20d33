// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_table_nearest() {
  return {.sentence =
              "A table of five colours is interpolated until frame 10, and then no longer. Its texels stay.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::vector<Colour> table{
                {200, 40, 40, 3}, {40, 60, 220, 30}, {230, 200, 40, 4}, {40, 200, 90, 28}, {220, 220, 230, 40}};
            return [&canvas, scene = slice_scene(canvas, {.table = table})](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              if (frame == 10) filter_linearly(canvas, GL_TEXTURE_2D, GL_NEAREST);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
