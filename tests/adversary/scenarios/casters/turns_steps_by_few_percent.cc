// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_steps_by_few_percent() {
  return {.sentence =
              "The step's length takes turns between 0.02 and, by a tenth longer, 0.022; from frame 10 on also "
              "0.021, "
              "from frame 20 on 0.0205 and 0.0215. Opacity is not corrected.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.step_length = 0.02F, .background = {0.9F, 0.9F, 0.85F, 1}});
            return [scene](int frame) {
              const bool even = frame % 2 == 0;
              float length = even ? 0.02F : 0.022F;
              if (frame >= 10 && frame % 3 == 2) length = 0.021F;
              if (frame >= 20) length = frame % 4 == 0 ? 0.0205F : frame % 4 == 2 ? 0.0215F : length;
              scene->program.use();
              scene->program.set("step_length", length);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
