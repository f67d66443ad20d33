// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario band_of_rare_values() {
  return {.sentence = "Between two values that a 64th of the range lies between, samples are opaque red.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  if (value > 0.6875 && value < 0.703125) colour = vec4(1.0, 0.1, 0.1, 0.8);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
