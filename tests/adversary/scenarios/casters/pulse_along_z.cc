// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario pulse_along_z() {
  return {.sentence =
              "A uniform of time, which changes in every frame, moves a band along z; it is within the volume "
              "from frame 8 on.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float time;)",
                                                                       R"(
  if (abs(here.z - time) < 0.06) colour.rgb = vec3(1.0, 0.9, 0.3);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("time", -0.5F + 0.06F * static_cast<float>(frame));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
