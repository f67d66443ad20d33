// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario plain_off_screen_then_window() {
  return {
      .sentence = "A plain volume, until frame 9 off screen and then shown, from frame 10 on into the window.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        return [offscreen, scene = slice_scene(canvas)](int frame) {
          if (frame >= 10) return scene->draw(frame);
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          scene->draw_slices(scene->camera(frame));
          offscreen->show();
        };
      }};
}

}  // namespace adversary::slices
