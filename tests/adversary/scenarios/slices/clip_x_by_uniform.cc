// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_x_by_uniform() {
  return {.sentence = "A uniform cuts what lies beyond a plane across x from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float limit;)",
                                                                                R"(
  if (at.x > limit) discard;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 10 ? 2.0F : 0.6F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
