// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario warped_coordinates() {
  return {.sentence = "The fragment shader bends the coordinate before it samples.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", R"(
  vec3 bent = at + 0.06 * sin(9.0 * at.yzx);
  colour = texture(table, vec2(texture(volume, bent).r, 0.5));)")})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
