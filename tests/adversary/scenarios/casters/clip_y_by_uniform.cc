// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clip_y_by_uniform() {
  return {.sentence = "A uniform cuts what lies beyond a plane across y, from the first frame on.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float limit;)",
                                                                       R"(
  if (here.y > limit) continue;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", 0.55F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
