// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario operator_changed() {
  return {.sentence = "Over until frame 9, maximum from frame 10, over again from frame 20.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas)](int frame) {
              scene->settings.blending = frame / 10 == 1 ? Blending::maximum : Blending::over;
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
