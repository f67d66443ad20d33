// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario by_derivatives() {
  return {
      .sentence = "Opacity depends on how fast the sample changes over the window (fwidth).",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        return [scene = slice_scene(canvas, {.fragment = slice_fragment_shader(
                                                 "", "  colour.a *= clamp(40.0 * fwidth(value), 0.0, 1.0);")})](
                   int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::slices
