// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario branch_to_place() {
  return {.sentence = "A uniform switches a tint by place on at frame 10, and off at frame 20.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform int mode;)",
                                                                                R"(
  if (mode == 1) colour.rgb *= vec3(at.z, 1.0, 1.0 - at.x);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("mode", frame / 10 == 1 ? 1 : 0);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
