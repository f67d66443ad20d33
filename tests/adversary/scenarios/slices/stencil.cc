// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario stencil() {
  return {.sentence = "A stencil shows the volume in the window's left half only.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Enable(GL_SCISSOR_TEST);
              canvas.gl.Scissor(0, 0, canvas.width() / 2, canvas.height());
              canvas.gl.ClearStencil(1);
              canvas.gl.Clear(GL_STENCIL_BUFFER_BIT);
              canvas.gl.ClearStencil(0);
              canvas.gl.Disable(GL_SCISSOR_TEST);
              canvas.gl.Enable(GL_STENCIL_TEST);
              canvas.gl.StencilFunc(GL_EQUAL, 1, 1);
              scene->draw_slices(scene->camera(frame));
              canvas.gl.Disable(GL_STENCIL_TEST);
            };
          }};
}

}  // namespace adversary::slices
