// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_scaled_by_a_vec4() {
  return {.sentence =
              "A vec4 scales colour and opacity; settings take turns, alike but for one channel: opacity by "
              "0.88, green "
              "by 0.9, and from frame 14 on, in place of the plain one, opacity by 0.94, then blue by 0.92.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster("uniform vec4 scale;", R"(
    colour *= scale;)"),
                                               .step_length = 0.015F});
            return [&canvas, scene](int frame) {
              Vector colour{1, 1, 1};
              float opacity = 1;
              if (frame % 3 == 1) opacity = 0.88F;
              if (frame % 3 == 2) colour.y = 0.9F;
              if (frame % 3 == 0 && frame >= 14) opacity = 0.94F;
              if (frame % 3 == 0 && frame >= 22) colour.z = 0.92F;
              scene->program.use();
              canvas.gl.Uniform4f(scene->program.location("scale"), colour.x, colour.y, colour.z, opacity);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
