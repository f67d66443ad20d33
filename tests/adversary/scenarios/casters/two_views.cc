// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario two_views() {
  return {.sentence = "The window's halves show the volume from two sides.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = caster_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              for (const int half : {0, 1}) {
                canvas.gl.Viewport(half * canvas.width() / 2, 0, canvas.width() / 2, canvas.height());
                const float sideways = half == 0 ? 20.0F : 100.0F;
                scene->draw_box(camera_at({.azimuth = sideways, .distance = 3.6F}, frame, 0.5F));
              }
            };
          }};
}

}  // namespace adversary::casters
