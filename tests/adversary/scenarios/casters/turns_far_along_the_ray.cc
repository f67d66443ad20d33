// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_far_along_the_ray() {
  return {.sentence =
              "Two settings take turns: colours as they are, or exchanged. From frame 10 on the plain one, and "
              "from frame "
              "20 on the other too, turns blue where a ray is longer than 0.95, as if there was mist.",
          .expectation = Expectation::either,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = over_caster("uniform float exchanged;\nuniform float mist_from;", R"(
    colour.rgb = mix(colour.rgb, colour.gbr, exchanged);
    if (float(i) * step_length > mist_from) colour = vec4(0.1, 0.2, 1.0, 2.0 * colour.a);)")});
            return [scene](int frame) {
              const bool even = frame % 2 == 0;
              scene->program.use();
              scene->program.set("exchanged", even ? 0.0F : 1.0F);
              scene->program.set("mist_from", frame >= (even ? 10 : 20) ? 0.95F : 9.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
