// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario tint_by_triangle() {
  return {.sentence = "Every third triangle is tinted, by gl_PrimitiveID.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = slice_scene(
                     canvas, {.fragment = slice_fragment_shader(
                                  "", "  if (gl_PrimitiveID % 3 == 0) colour.rgb *= vec3(0.2, 1.0, 0.4);")})](
                    int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
