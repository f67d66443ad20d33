// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario pulse_where_high() {
  return {.sentence = "From frame 10 on, samples of high values, and no others, follow a uniform of time.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float time;)",
                                                                       R"(
  if (value > 0.6 && time > 10.0) colour = vec4(1.0, 1.0, 0.5 + 0.5 * sin(time), 2.0 * colour.a);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("time", static_cast<float>(frame));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
