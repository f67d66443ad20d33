// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_gain_above_one() {
  return {.sentence =
              "A gain for the colours is raised from 1 to 2 at frame 10: the fragments are brighter than 1, as "
              "far as which the window holds them.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            // The exact reference's framebuffer holds more, unless it is told not to.
            if (canvas.exact()) canvas.gl.ClampColor(GL_CLAMP_FRAGMENT_COLOR, GL_TRUE);
            auto scene = slice_scene(
                canvas, {.fragment = slice_fragment_shader("uniform float gain;", "  colour.rgb *= gain;")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("gain", frame < 10 ? 1.0F : 2.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
