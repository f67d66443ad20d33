// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario all_discarded_then_some() {
  return {.sentence =
              "Samples below a threshold are discarded. It is above all samples until frame 5, and then "
              "among them.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {5},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene =
                slice_scene(canvas, {.fragment = slice_fragment_shader("uniform float threshold;\n",
                                                                       "if (value < threshold) discard;")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("threshold", frame < 5 ? 2.0F : 0.4F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
