// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario away_then_tinted() {
  return {.sentence = "The camera looks past the volume until frame 5; colours depend on z.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  colour.rgb *= vec3(here.z, 1.0, 1.0 - here.z);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->settings.orbit.sideways = frame < 6 ? 3.0F : 0.0F;
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
