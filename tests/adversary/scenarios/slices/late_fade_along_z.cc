// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario late_fade_along_z() {
  return {.sentence = "A uniform fades opacity along z, a little more in every frame from 10 to 19.",
          .expectation = Expectation::either,
          .key_frames = {10, 11, 12, 13, 14, 15, 16, 17, 18, 19},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float strength;)",
                                                                                R"(
  colour.a *= 1.0 - strength * at.z;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("strength", 0.1F * static_cast<float>(std::clamp(frame - 9, 0, 10)));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
