// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_six_small_tints() {
  return {.sentence =
              "Six settings in rotation, whose red, green or blue differ by 12/255 or 20/255 from the plain "
              "one's. From "
              "frame 18 on three others stand between them, which differ from these by 10/255.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster("uniform vec3 added;", R"(
    colour.rgb = 0.85 * colour.rgb + added;)"),
                                               .step_length = 0.015F});
            return [scene](int frame) {
              constexpr std::array<Vector, 6> steps{Vector{0, 0, 0}, {12, 0, 0}, {0, 12, 0},
                                                    {0, 0, 12},      {20, 0, 0}, {0, 20, 0}};
              Vector added = steps[static_cast<std::size_t>(frame % 6)];
              if (frame >= 18 && frame % 2 == 1) added = added + Vector{0, 0, 10};
              scene->program.use();
              scene->program.set("added", (1 / 255.0F) * added);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
