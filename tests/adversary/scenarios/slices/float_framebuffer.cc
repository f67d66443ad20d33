// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario float_framebuffer() {
  return {.sentence = "Slices into a framebuffer object of half floats, which is then shown.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA16F);
            return [&canvas, offscreen, scene = slice_scene(canvas)](int frame) {
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              scene->draw_slices(scene->camera(frame));
              offscreen->show();
            };
          }};
}

}  // namespace adversary::slices
