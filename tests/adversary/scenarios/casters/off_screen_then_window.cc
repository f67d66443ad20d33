// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario off_screen_then_window() {
  return {.sentence =
              "Until frame 9 off screen and then shown, from frame 10 on into the window; colours depend on z.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
            auto scene = caster_scene(canvas, {.fragment = over_caster("", "  colour.r *= here.z;")});
            return [offscreen, scene](int frame) {
              if (frame >= 10) return scene->draw(frame);
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              scene->draw_box(scene->camera(frame));
              offscreen->show();
            };
          }};
}

}  // namespace adversary::casters
