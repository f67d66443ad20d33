// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario pulse_of_time() {
  return {.sentence = "Brightness follows a uniform of time in every frame.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float time;)",
                                                                                R"(
  colour.rgb *= 0.6 + 0.4 * sin(time);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("time", 0.4F * static_cast<float>(frame));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
