// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario window_edited() {
  return {.sentence = "Grey levels by a window of values that the user drags from frame 8 to 19.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas, {.fragment = over_caster("uniform float low, high;", R"(
    float grey = clamp((value - low) / (high - low), 0.0, 1.0);
    colour = vec4(vec3(grey), 0.12 * grey);)")})](int frame) {
              const float dragged = static_cast<float>(std::clamp(frame - 7, 0, 12));
              scene->program.use();
              scene->program.set("low", 0.1F + 0.03F * dragged);
              scene->program.set("high", 0.9F - 0.01F * dragged);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
