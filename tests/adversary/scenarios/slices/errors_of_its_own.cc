// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario errors_of_its_own() {
  return {
      .sentence =
          "Every third frame passes an unknown capability before the volume is drawn, and asks for the "
          "error only after it.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        return [&canvas, scene = slice_scene(canvas)](int frame) {
          if (frame % 3 == 0) canvas.gl.Enable(GL_TEXTURE0);
          scene->draw(frame);
          canvas.gl.Finish();
          for (int i = 0; i < 2; ++i)
            canvas.note("error " + std::to_string(canvas.gl.GetError()) + " in frame " + std::to_string(frame));
        };
      }};
}

}  // namespace adversary::slices
