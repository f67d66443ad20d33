// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario volume_replaced_every_frame() {
  return {.sentence = "A series of volumes: every frame replaces all texels by others.",
          .expectation = Expectation::must_be_substituted,
          .most_compared = 10,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas);
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              const float phase = 0.02F * static_cast<float>(frame);
              replace_texels(
                  canvas, sampled(48, [&](float x, float y, float z) { return waves(x + phase, y, z); }), {});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
