// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clamping_turned_off() {
  return {.sentence =
              "Slices of three times their colours into half floats, in a compatibility profile. Fragments are "
              "clamped until frame 10, and then no longer. The camera stands still.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA16F);
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour.rgb *= 3.0;"),
                                              .orbit = {.degrees_each_frame = 0}});
            return [&canvas, offscreen, scene](int frame) {
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              canvas.gl.ClampColor(GL_CLAMP_FRAGMENT_COLOR, frame < 10 ? GL_TRUE : GL_FALSE);
              scene->draw_slices(scene->camera(frame));
              canvas.gl.ClampColor(GL_CLAMP_FRAGMENT_COLOR, GL_FIXED_ONLY);
              offscreen->show();
            };
          }};
}

}  // namespace adversary::slices
