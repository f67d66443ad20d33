// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario late_rare_band() {
  return {.sentence = "From frame 10 on, a band of values as wide as a 64th of the range becomes white.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform bool marked;)",
                                                                                R"(
  if (marked && value > 0.609375 && value < 0.625) colour = vec4(1.0, 1.0, 1.0, 0.3);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("marked", frame < 10 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
