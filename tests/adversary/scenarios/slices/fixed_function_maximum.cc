// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fixed_function_maximum() {
  return {.sentence = "Fixed function: maximum of luminances.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, sampled(48, shells), {.shown = Shown::luminance});
            return [&canvas](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              canvas.gl.Enable(GL_TEXTURE_3D);
              canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
              set_blending(canvas.gl, Blending::maximum);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 48));
            };
          }};
}

}  // namespace adversary::slices
