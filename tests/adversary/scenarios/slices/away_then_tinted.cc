// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario away_then_tinted() {
  return {.sentence = "The camera looks past the volume until frame 5; colours depend on z.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  colour.rgb *= vec3(at.z, 1.0, 1.0 - at.z);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->settings.orbit.sideways = frame < 6 ? 3.0F : 0.0F;
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
