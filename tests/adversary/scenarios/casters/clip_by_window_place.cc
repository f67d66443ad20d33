// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clip_by_window_place() {
  return {.sentence = "A slider over the window hides what lies right of it, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float limit;)",
                                                                       R"(
  if (gl_FragCoord.x > limit) continue;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 10 ? 1000.0F : 150.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
