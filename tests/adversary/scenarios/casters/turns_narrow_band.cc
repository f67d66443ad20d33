// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_narrow_band() {
  return {.sentence =
              "Even frames are plain, in odd ones a narrow band of values gleams. From frame 10 on the even "
              "ones have a "
              "band as narrow at another value, from frame 20 on odd ones too, beside it.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster("uniform float band;", R"(
    if (abs(value - band) < 0.014) colour = vec4(1.0, 0.9, 0.2, 0.35);)")});
            return [scene](int frame) {
              const float even = frame < 10 ? 2.0F : 0.83F;
              const float odd = frame < 20 ? 0.4F : 0.8F;
              scene->program.use();
              scene->program.set("band", frame % 2 == 0 ? even : odd);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
