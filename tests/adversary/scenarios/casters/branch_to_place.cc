// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario branch_to_place() {
  return {.sentence = "A uniform switches a tint by place on at frame 10, and off at frame 20.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform int mode;)",
                                                                       R"(
  if (mode == 1) colour.rgb *= vec3(here.z, 1.0, 1.0 - here.x);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("mode", frame / 10 == 1 ? 1 : 0);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
