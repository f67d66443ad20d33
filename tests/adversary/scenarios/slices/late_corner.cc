// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario late_corner() {
  return {.sentence = "A uniform tints one corner of the volume, a fifth along each axis, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform bool tinted;)",
                                                                                R"(
  if (tinted && all(greaterThan(at, vec3(0.8)))) colour = vec4(1.0, 0.9, 0.2, 4.0 * colour.a);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("tinted", frame < 10 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
