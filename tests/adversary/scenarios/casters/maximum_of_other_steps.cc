// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario maximum_of_other_steps() {
  return {.sentence = "The largest value along the ray; from frame 10 on steps are four times as long.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                   {.before = "  float largest = 0.0;",
                                                    .each = "    largest = max(largest, value);",
                                                    .after = "  shown = texture(table, vec2(largest, 0.5));"}),
                                               .table = opaque_colours()})](int frame) {
                  scene->program.use();
                  scene->program.set("step_length", frame < 10 ? 0.025F : 0.1F);
                  scene->draw(frame);
                };
          }};
}

}  // namespace adversary::casters
