// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario matrix_of_fixed_function() {
  return {.sentence =
              "The camera is a uniform and stands still. The fragment shader reads a tint from the model-view "
              "matrix of fixed function, which is another from frame 10 on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string fragment = over_caster("", "    colour.rgb *= gl_ModelViewMatrix[0].xyz;");
            auto scene = caster_scene(
                canvas, {.fragment = "#version 330 compatibility" + fragment.substr(fragment.find('\n')),
                         .orbit = {.degrees_each_frame = 0}});
            return [&canvas, scene](int frame) {
              Matrix tint{};
              tint[0] = 1;
              tint[1] = frame < 10 ? 1.0F : 0.3F;
              tint[2] = tint[5] = tint[10] = tint[15] = 1;
              canvas.gl.MatrixMode(GL_MODELVIEW);
              canvas.gl.LoadMatrixf(tint.data());
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
