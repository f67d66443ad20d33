// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario crop_by_uniform_box() {
  return {.sentence = "Two corners in uniforms crop the volume; the user drags one of them from frame 8 to 17.",
          .expectation = Expectation::either,
          .key_frames = {8, 9, 10, 11, 12, 13, 14, 15, 16, 17},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas, {.fragment = over_caster("uniform vec3 low, high;", R"(
    if (any(lessThan(here, low)) || any(greaterThan(here, high))) continue;)")})](int frame) {
              const float dragged = 0.03F * static_cast<float>(std::clamp(frame - 7, 0, 10));
              scene->program.use();
              scene->program.set("low", Vector{0.1F, 0.05F, 0.1F});
              scene->program.set("high", Vector{0.95F, 0.95F - dragged, 0.9F});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
