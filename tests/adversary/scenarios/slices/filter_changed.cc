// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario filter_changed() {
  return {.sentence = "Interpolation is switched off at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
)")});
            return [&canvas, scene](int frame) {
              scene->program.use();
              if (frame == 10) {
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                filter_linearly(canvas, GL_TEXTURE_3D, GL_NEAREST);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
