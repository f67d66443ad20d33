// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario float_values() {
  return {.sentence = "Floats from -1000 to 3000, as a tomograph's, through a window in uniforms and a table.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas,
                                        {.fragment = slice_fragment_shader(
                                             "uniform float low, width;",
                                             "  colour = texture(table, vec2((value - low) / width, 0.5));"),
                                         .grid = scaled(sampled(48, waves), 4000, -1000),
                                         .format = {.texel = Texel::float32}})](int frame) {
              scene->program.use();
              scene->program.set("low", -800.0F);
              scene->program.set("width", 3500.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
