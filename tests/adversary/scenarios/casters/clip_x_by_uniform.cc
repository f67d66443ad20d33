// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clip_x_by_uniform() {
  return {.sentence = "A uniform cuts what lies beyond a plane across x from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float limit;)",
                                                                       R"(
  if (here.x > limit) continue;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 10 ? 2.0F : 0.6F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
