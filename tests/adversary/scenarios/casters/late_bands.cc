// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_bands() {
  return {.sentence = "Bands across z become white where the value is high, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform bool banded;)",
                                                                       R"(
  if (banded && fract(4.0 * here.z) < 0.4 && value > 0.55) colour.rgb = vec3(1.0);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("banded", frame < 10 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
