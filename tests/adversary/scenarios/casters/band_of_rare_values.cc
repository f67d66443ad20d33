// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario band_of_rare_values() {
  return {.sentence = "Between two values that a 64th of the range lies between, samples are opaque red.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  if (value > 0.6875 && value < 0.703125) colour = vec4(1.0, 0.1, 0.1, 0.8);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
