// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario chequered_discard() {
  return {.sentence = "Every other pixel of a chequered pattern is discarded, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = slice_scene(canvas, {.fragment = slice_fragment_shader("uniform bool chequered;", R"(
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (chequered && (pixel.x + pixel.y) % 2 == 0) discard;)")})](int frame) {
                  scene->program.use();
                  scene->program.set("chequered", frame < 10 ? 0 : 1);
                  scene->draw(frame);
                };
          }};
}

}  // namespace adversary::slices
