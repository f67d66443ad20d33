// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario multisampled_framebuffer() {
  return {.sentence = "Slices into a framebuffer object of four samples a pixel, resolved and shown.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8, 4);
            return [offscreen,
                    scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour.a *= 0.5;"),
                                                 .slices = 128})](int frame) {
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              scene->draw_slices(scene->camera(frame));
              offscreen->show();
            };
          }};
}

}  // namespace adversary::slices
