// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario alpha_test_raised() {
  return {
      .sentence =
          "A compatibility profile. An alpha test discards rays of opacity 0. The camera stands still. From "
          "frame 10 on, the test discards rays whose opacity is at most one half.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.orbit = {.degrees_each_frame = 0}});
        canvas.gl.Enable(GL_ALPHA_TEST);
        return [&canvas, scene](int frame) {
          canvas.gl.AlphaFunc(GL_GREATER, frame < 10 ? 0.0F : 0.5F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
