// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario window_resized() {
  return {.sentence = "The window has another size from frame 12 on, and a third from frame 20.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = caster_scene(canvas)](int frame) {
              if (frame == 12) canvas.resize(320, 208);
              if (frame == 20) canvas.resize(177, 243);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
