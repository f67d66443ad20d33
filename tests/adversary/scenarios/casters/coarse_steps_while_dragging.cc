// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario coarse_steps_while_dragging() {
  return {.sentence = "Steps are twice as long in frames 8 to 15 and 24 to 29; a uniform corrects the opacity.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {8, 16, 24},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas, {.fragment = over_caster("", R"(
    colour.a = 1.0 - pow(1.0 - colour.a, step_length / 0.025);)")})](int frame) {
              scene->program.use();
              scene->program.set("step_length", frame / 8 % 2 == 0 ? 0.025F : 0.05F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
