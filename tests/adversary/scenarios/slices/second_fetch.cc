// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario second_fetch() {
  return {.sentence = "The sample is the mean of two texels that lie apart.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform vec3 apart;)",
                                                                                R"(
  colour = texture(table, vec2(0.5 * (value + texture(volume, at + apart).r), 0.5));)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("apart", Vector{0.06F, 0.03F, -0.05F});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
