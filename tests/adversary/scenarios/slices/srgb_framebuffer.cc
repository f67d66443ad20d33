// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario srgb_framebuffer() {
  return {.sentence = "Slices blended in an sRGB framebuffer object, which is then shown.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_SRGB8_ALPHA8);
            return [&canvas, offscreen, scene = slice_scene(canvas)](int frame) {
              canvas.gl.Enable(GL_FRAMEBUFFER_SRGB);
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              scene->draw_slices(scene->camera(frame));
              canvas.gl.Disable(GL_FRAMEBUFFER_SRGB);
              offscreen->show();
            };
          }};
}

}  // namespace adversary::slices
