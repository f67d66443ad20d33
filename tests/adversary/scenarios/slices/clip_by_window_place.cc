// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_by_window_place() {
  return {.sentence = "A slider over the window hides what lies right of it, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float limit;)",
                                                                                R"(
  if (gl_FragCoord.x > limit) discard;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 10 ? 1000.0F : 150.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
