// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_y_by_uniform() {
  return {.sentence = "A uniform cuts what lies beyond a plane across y, from the first frame on.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float limit;)",
                                                                                R"(
  if (at.y > limit) discard;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", 0.55F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
