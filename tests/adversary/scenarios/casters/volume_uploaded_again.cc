// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario volume_uploaded_again() {
  return {.sentence = "Another volume of the same size comes with glTexSubImage3D at frame 12.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = caster_scene(canvas)](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              if (frame == 12) replace_texels(canvas, sampled(48, shells), scene->settings.format);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
