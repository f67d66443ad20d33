// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario alpha_test_turned_on() {
  return {.sentence =
              "A compatibility profile. The camera stands still. From frame 10 on, an alpha test discards rays "
              "whose opacity is at most one half.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.orbit = {.degrees_each_frame = 0}});
            canvas.gl.AlphaFunc(GL_GREATER, 0.5F);
            return [&canvas, scene](int frame) {
              if (frame == 10) canvas.gl.Enable(GL_ALPHA_TEST);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
