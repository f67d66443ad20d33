// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario unsigned_16() {
  return {.sentence = "16 bits of which the volume uses 0 to 1300, spread by a factor in the shader.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(
                        canvas, {.fragment = slice_fragment_shader(
                                     "", "  colour = texture(table, vec2(value * 65535.0 / 1300.0, 0.5));"),
                                 .grid = scaled(sampled(48, waves), 1300.0F / 65535),
                                 .format = {.texel = Texel::unsigned16}})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
