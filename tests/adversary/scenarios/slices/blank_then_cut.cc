// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario blank_then_cut() {
  return {
      .sentence = "The first six frames show nothing; then opacity comes, and what lies beyond z = 0.5 is cut.",
      .expectation = Expectation::either,
      .key_frames = {6},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float opacity;)",
                                                                            R"(
  if (at.z > 0.5) discard;
  colour.a *= opacity;)")});

        return [scene](int frame) {
          scene->program.use();
          scene->program.set("opacity", frame < 6 ? 0.0F : 1.0F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
