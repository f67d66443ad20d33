// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario filter_changed() {
  return {.sentence = "Interpolation is switched off at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
)")});
            return [&canvas, scene](int frame) {
              scene->program.use();
              if (frame == 10) {
                canvas.gl.ActiveTexture(GL_TEXTURE0);
                filter_linearly(canvas, GL_TEXTURE_3D, GL_NEAREST);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
