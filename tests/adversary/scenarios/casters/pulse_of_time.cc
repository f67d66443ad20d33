// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario pulse_of_time() {
  return {.sentence = "Brightness follows a uniform of time in every frame.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float time;)",
                                                                       R"(
  colour.rgb *= 0.6 + 0.4 * sin(time);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("time", 0.4F * static_cast<float>(frame));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
